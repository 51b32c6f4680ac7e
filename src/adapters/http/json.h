// The documents that are sent and received.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace culprit::web {

using Json = nlohmann::ordered_json;  // members stay in the order in which they were written

// On one line; what is no UTF-8 is replaced, for robots name things as they like.
std::string to_line(const Json& json);

}  // namespace culprit::web
