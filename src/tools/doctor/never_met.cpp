#include "doctor/never_met.h"

#include <algorithm>
#include <array>

#include "base/tool_names.h"
#include "ros2/names.h"

namespace culprit::doctor {
namespace {

bool is_called(std::string_view service) {
  constexpr std::array<std::string_view, 3> kCalled = {"/get_parameters", "/get_state",
                                                       "/list_parameters"};
  return std::ranges::any_of(kCalled,
                             [&](std::string_view name) { return service.ends_with(name); });
}

bool is_read(const std::string& topic) {
  return !is_topic_of_ros(topic) || topic == "/diagnostics" || topic == "/clock";
}

}  // namespace

bool never_meets(std::string_view dds_topic, rtps::EndpointRole role) {
  const auto meaning = ros2::demangle_topic(dds_topic);
  if (!meaning) return false;  // ros_discovery_info, and what is not of ROS
  const bool reads = role == rtps::EndpointRole::kReader;
  switch (meaning->channel) {
    case ros2::Channel::kTopic:
      return reads || !is_read(meaning->name);
    case ros2::Channel::kRequest:
      return !reads || !is_called(meaning->name);
    case ros2::Channel::kReply:
      return reads || !is_called(meaning->name);
  }
  return false;
}

}  // namespace culprit::doctor
