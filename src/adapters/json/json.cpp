#include "json/json.h"

#include <set>
#include <string>
#include <vector>

namespace culprit {

namespace {

// The library copies, compares and writes documents recursively: a deep one overflows the stack.
bool is_too_deep(std::string_view text) {
  constexpr int kDeepest = 500;
  int depth = 0;
  bool is_inside_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_inside_text && c == '\\') ++i;
    if (c == '"') is_inside_text = !is_inside_text;
    if (is_inside_text) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return true;
  }
  return false;
}

}  // namespace

Json parse_json(std::string_view text) {
  if (is_too_deep(text)) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

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
