// A value that came and cannot be read: its message cannot be decoded, has no such element, or has a text that is too long.
//
// It is of no type, so what rules read of it is unknown from then on: the value before no longer counts.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/value.h"

namespace culprit {

// No text of ROS 2 contains a NUL, so none is taken for it.
inline constexpr std::string_view kUnreadable{"\0unreadable", 11};

inline Value unreadable_value() { return std::string(kUnreadable); }

// A text of a rule, and so one that a trigger can compare it with, is far shorter; kept and journaled are both.
inline constexpr std::size_t kLongestText = std::size_t{1} << 20;  // bytes

inline Value readable(Value value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr && text->size() > kLongestText ? unreadable_value() : value;
}

inline bool is_unreadable(const Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr && *text == kUnreadable;
}

}  // namespace culprit
