#include "lsp/live_names.h"

#include "base/ros_names.h"

namespace culprit::lsp {

namespace {

using Kind = Proposal::Kind;

}  // namespace

std::vector<Proposal> live_nodes(const LiveInventory& robot) {
  std::vector<Proposal> out;
  for (const auto& [name, node] : robot.nodes)
    out.push_back({Kind::kComponent, name, node.lifecycle.empty() ? "node" : node.lifecycle});
  return out;
}

std::vector<Proposal> live_topics(const LiveInventory& robot) {
  std::vector<Proposal> out;
  for (const auto& [name, topic] : robot.topics) {
    if (topic.is_published()) out.push_back({Kind::kTopic, name, topic.type});
  }
  return out;
}

std::vector<Proposal> live_parameters(const LiveInventory& robot, const Component& component) {
  std::vector<Proposal> out;
  const auto node = robot.nodes.find(robot.node_of(component));
  if (node == robot.nodes.end() || !node->second.parameters) return out;
  for (const auto& [name, value] : *node->second.parameters)
    out.push_back({Kind::kParameter, name, value ? to_string(*value) : ""});
  return out;
}

std::vector<Proposal> live_routines(const LiveInventory& robot) {
  std::vector<Proposal> out;
  // Every node's standard services have adaptations of their own.
  const auto is_standard = [](const std::string& type) {
    return type.starts_with("rcl_interfaces/") || type.starts_with("lifecycle_msgs/") ||
           type.starts_with("type_description_interfaces/");
  };
  for (const auto& [name, type] : robot.services) {
    if (!is_standard(type)) out.push_back({Kind::kService, name, type});
  }
  return out;
}

std::vector<Proposal> live_statuses(const LiveInventory& robot) {
  std::vector<Proposal> out;
  for (const LiveInventory::Status& status : robot.diagnostics) {
    std::string name = as_written(status.name);
    if (!name.empty()) out.push_back({Kind::kStatus, std::move(name), status.hardware_id});
  }
  return out;
}

std::vector<Proposal> live_keys(const LiveInventory& robot, const std::string& status) {
  std::vector<Proposal> out;
  for (const LiveInventory::Status& candidate : robot.diagnostics) {
    if (!candidate.is_called(status)) continue;
    for (const auto& [key, value] : candidate.values) {
      std::string name = as_written(key);
      if (!name.empty()) out.push_back({Kind::kStatus, std::move(name), value});
    }
  }
  return out;
}

}  // namespace culprit::lsp
