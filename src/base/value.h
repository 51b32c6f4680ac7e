// The value of a signal, a parameter or a constant.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace culprit {

// ROS parameters and diagnostics know no more than these four; integers are 64 bit as in
// rcl_interfaces.
using Value = std::variant<bool, std::int64_t, double, std::string>;

// As the rule language writes it: true, 3, 0.5, "text". A double always shows a point or an
// exponent.
std::string to_string(const Value& value);

// The reading of a diagnostic's text (diagnostic_msgs/KeyValue carries strings only): an integer, a
// number, true/false in any case, otherwise the text itself. Surrounding blanks do not count.
Value value_from_text(std::string_view text);

}  // namespace culprit
