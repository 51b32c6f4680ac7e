#include "web/calls.h"

namespace culprit::web {

std::vector<http::Route> recording_routes(RecordNow record) {
  return {{http::Method::kPost, "/api/recordings",
           [record = std::move(record)](const Json& body) {
             if (!record)
               return http::refuse(
                   409, "this culprit records nothing: start it with culprit run --record");
             const auto reason = http::text_of(body, "reason");
             if (!reason) return http::refuse(400, "say what it is called: 'reason'");
             const auto path = record(*reason);
             return path ? http::Answer{200, {{"recording", path->string()}}}
                         : http::refuse(503, path.error());
           },
           http::Role::kOperate}};
}

}  // namespace culprit::web
