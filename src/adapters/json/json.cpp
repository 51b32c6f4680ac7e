#include "json/json.h"

namespace culprit {

Json parse_json(std::string_view text) { return Json::parse(text, nullptr, false); }

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_indented(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace culprit
