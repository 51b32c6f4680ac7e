#include "base/tool_names.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "base/ros_names.h"

namespace culprit {

bool is_topic_of_ros(const std::string& topic) {
  constexpr std::array kOfRos = {"/rosout", "/parameter_events", "/diagnostics", "/clock"};
  return std::ranges::find(kOfRos, topic) != kOfRos.end() || own_name(topic).starts_with('_') ||
         topic.ends_with("/transition_event");
}

bool is_culprits_node(const std::string& node) {
  constexpr std::string_view kName = "culprit";
  const std::string name = own_name(node);
  if (!name.starts_with(kName)) return false;
  const std::string_view number = std::string_view(name).substr(kName.size());
  return number.empty() ||
         (number.size() > 1 && number.front() == '_' &&
          std::ranges::all_of(number.substr(1), [](char c) { return c >= '0' && c <= '9'; }));
}

bool is_culprits_status(const std::string& name, const std::string& hardware_id) {
  return hardware_id == kCulpritsHardwareId && (name == "culprit" || name.starts_with("culprit: "));
}

bool is_tool_node(const std::string& node) {
  constexpr std::array kTools = {"_", "transform_listener_impl_", "launch_ros_", "rviz"};
  const std::string name = own_name(node);
  return is_culprits_node(node) ||
         std::ranges::any_of(kTools, [&](const char* prefix) { return name.starts_with(prefix); });
}

}  // namespace culprit
