#include "doctor/wiring.h"

#include <algorithm>
#include <array>

#include "base/ros_names.h"
#include "base/tool_names.h"

namespace culprit::doctor {

Wiring wiring_of(const Picture& picture) {
  Wiring wiring;
  for (const auto& [node, endpoints] : picture.nodes) {
    if (own_name(node.name).starts_with('_')) continue;
    for (const ros2::GraphEndpoint& each : endpoints) {
      const bool is_topic =
          each.kind == EndpointKind::kPublisher || each.kind == EndpointKind::kSubscriber;
      const bool sends =
          each.kind == EndpointKind::kPublisher || each.kind == EndpointKind::kClient;
      Channel& channel = (is_topic ? wiring.topics : wiring.services)[each.name];
      (sends ? channel.senders : channel.receivers).push_back({node.name, node.vendor, each});
    }
  }
  return wiring;
}

bool is_name_of_each_node(const std::string& name) {
  constexpr std::array kServices = {
      "get_parameters",      "get_parameter_types",       "set_parameters",      "list_parameters",
      "describe_parameters", "set_parameters_atomically", "get_type_description"};
  return is_topic_of_ros(name) || std::ranges::find(kServices, own_name(name)) != kServices.end();
}

bool has_robots_end(const std::vector<End>& ends) {
  return std::ranges::any_of(ends, [](const End& end) { return !is_tool_node(end.node); });
}

}  // namespace culprit::doctor
