#include "base/name_grammar.h"
#include "web/calls.h"

namespace culprit::web {

std::vector<Route> reload_routes(Reload reload) {
  return {{Method::kPost, "/api/rules/reload", [reload = std::move(reload)](const Json& body) {
             const std::string author = text_of(body, "author").value_or("");
             if (author.empty()) return refuse(400, "name the author: 'author'");
             const auto count = reload(escape_controls(author));
             if (!count) return refuse(422, count.error());
             // An event "reloaded" says when it is done.
             return Answer{202, {{"rules", *count}}};
           }}};
}

}  // namespace culprit::web
