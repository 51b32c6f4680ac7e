// A value that came and cannot be read: its message cannot be decoded, or has no such element.
//
// It is of no type, so what rules read of it is unknown from then on: the value before no longer counts.
#pragma once

#include <string_view>

#include "base/value.h"

namespace culprit {

// No text of ROS 2 contains a NUL, so none is taken for it.
inline constexpr std::string_view kUnreadable{"\0unreadable", 11};

inline Value unreadable_value() { return std::string(kUnreadable); }

inline bool is_unreadable(const Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr && *text == kUnreadable;
}

}  // namespace culprit
