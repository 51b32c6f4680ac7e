// The fields of the standard message types and of common packages (as of Humble), so that the common
// signals need no ROS installation.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace culprit::ros2 {

struct StandardMessage {
  std::string_view type;  // "package/msg/Type"
  std::string_view text;  // as in a .msg file, fields only
};

std::span<const StandardMessage> standard_messages();

std::optional<std::string_view> standard_message(std::string_view type);

}  // namespace culprit::ros2
