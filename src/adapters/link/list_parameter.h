// Parameters that are lists, as texts (base/value_list.h): a rule has no other way to hold them.
#pragma once

#include <optional>
#include <string>

#include "base/value.h"
#include "ros2/messages.h"

namespace culprit::link {

bool is_list(const ros2::msg::ParameterValue& value);

// A single value as it is; a list as its text. Nothing: not set.
std::optional<Value> value_or_list(const ros2::msg::ParameterValue& value);

// The list that `text` means, for a parameter of this type (ParameterType). Nothing: it is none, or has
// other elements.
std::optional<ros2::msg::ParameterValue> list_parameter(const std::string& text, std::uint8_t type);

}  // namespace culprit::link
