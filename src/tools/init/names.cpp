#include "init/names.h"

#include <algorithm>
#include <array>

#include "base/ros_names.h"

namespace culprit::init {

bool is_of_ros(const std::string& topic) {
  constexpr std::array kOfRos = {"/rosout", "/parameter_events", "/diagnostics", "/clock"};
  return std::ranges::find(kOfRos, topic) != kOfRos.end() || own_name(topic).starts_with('_') ||
         topic.ends_with("/transition_event");
}

bool is_tool(const std::string& node) {
  constexpr std::array kTools = {"_", "transform_listener_impl_", "launch_ros_", "rviz"};
  const std::string name = own_name(node);
  return name == "culprit" ||
         std::ranges::any_of(kTools, [&](const char* prefix) { return name.starts_with(prefix); });
}

}  // namespace culprit::init
