#include "base/name_grammar.h"
#include "web/calls.h"

namespace culprit::web {

std::vector<http::Route> reload_routes(Reload reload) {
  return {
      {http::Method::kPost, "/api/rules/reload", [reload = std::move(reload)](const Json& body) {
         const std::string author = http::text_of(body, "author").value_or("");
         if (author.empty()) return http::refuse(400, "name the author: 'author'");
         const auto count = reload(escape_controls(author));
         if (!count) return http::refuse(422, count.error());
         // An event "reloaded" says when it is done.
         return http::Answer{202, {{"rules", *count}}};
       }}};
}

}  // namespace culprit::web
