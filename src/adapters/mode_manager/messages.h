// The message types of system_modes that a mode manager speaks beside those in ros2/services.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace culprit::mode_manager::msg {

struct Mode {
  static constexpr std::string_view kType = "system_modes_msgs/msg/Mode";
  std::string label;
  static void visit(auto& self, auto& each) { each(self.label); }
};

struct ModeEvent {
  static constexpr std::string_view kType = "system_modes_msgs/msg/ModeEvent";
  std::uint64_t timestamp = 0;  // ns
  Mode start_mode;
  Mode goal_mode;
  static void visit(auto& self, auto& each) {
    each(self.timestamp, self.start_mode, self.goal_mode);
  }
};

}  // namespace culprit::mode_manager::msg

namespace culprit::mode_manager::srv {

struct GetAvailableModes {
  static constexpr std::string_view kType = "system_modes_msgs/srv/GetAvailableModes";
  struct Request {};
  struct Response {
    std::vector<std::string> available_modes;
    static void visit(auto& self, auto& each) { each(self.available_modes); }
  };
};

}  // namespace culprit::mode_manager::srv
