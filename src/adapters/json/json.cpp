#include "json/json.h"

#include <set>
#include <string>
#include <vector>

namespace culprit {

Json parse_json(std::string_view text) { return Json::parse(text, nullptr, false); }

Json parse_strict_json(std::string_view text) {
  constexpr int kDeepest = 100;
  std::vector<std::set<std::string>> names;  // of the objects that are open
  bool is_refused = false;
  const Json::parser_callback_t look = [&](int depth, Json::parse_event_t event, Json& parsed) {
    is_refused |= depth > kDeepest;
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key)
      is_refused |= !names.back().insert(parsed.get<std::string>()).second;
    return true;
  };
  Json json = Json::parse(text, look, false);
  return is_refused ? Json(Json::value_t::discarded) : json;
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_indented(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace culprit
