#include "http/json.h"

namespace culprit::web {

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace culprit::web
