// A line of JSON with a check of its integrity: its last field is the CRC-32 of the line as it
// would be without it.
//
//     {"row":0,"run":3,"ratio":1.5,"check":"1c291ca3"}
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "json/json.h"

namespace culprit::study {

// With a line end. `json` is an object with at least one field.
std::string sealed_line(const Json& json);

// The object without the seal; nothing if the line was changed, or never was sealed. `line` has no
// line end.
std::optional<Json> unsealed(std::string_view line);

}  // namespace culprit::study
