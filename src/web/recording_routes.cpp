#include "web/calls.h"

namespace culprit::web {

std::vector<Route> recording_routes(RecordNow record) {
  return {{Method::kPost, "/api/recordings",
           [record = std::move(record)](const Json& body) {
             if (!record)
               return refuse(409,
                             "this culprit records nothing: start it with culprit run --record");
             const auto reason = text_of(body, "reason");
             if (!reason) return refuse(400, "say what it is called: 'reason'");
             const auto path = record(*reason);
             return path ? Answer{200, {{"recording", path->string()}}} : refuse(503, path.error());
           },
           Role::kOperate}};
}

}  // namespace culprit::web
