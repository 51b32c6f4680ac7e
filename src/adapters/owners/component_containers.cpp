#include "owners/component_containers.h"

#include <unistd.h>

namespace culprit::owners {
namespace {

// ROS 2's ComponentManager.
constexpr std::string_view kLoad = "/_container/load_node";

}  // namespace

void ComponentContainers::observe(const Observation& observation) {
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
    const auto component = binding_.bind(node->node);
    processes_[node->node] = node->pid;
    if (component) last_[*component] = node->pid;
  } else if (const auto* gone = std::get_if<NodeVanished>(&observation.what)) {
    processes_.erase(gone->node);
    containers_.erase(gone->node);
  } else if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) {
    if (end->kind == EndpointKind::kServer && end->name == end->node + std::string(kLoad))
      containers_.insert(end->node);
  }
}

std::optional<ComponentContainers::Home> ComponentContainers::home_of(ComponentId component) const {
  const auto last = last_.find(component);
  if (last == last_.end() || last->second == 0) return std::nullopt;
  const std::string& self = binding_.node_of(component);
  if (containers_.contains(self)) return std::nullopt;
  Home home;
  for (const auto& [node, process] : processes_) {
    if (process != last->second || node == self) continue;
    if (containers_.contains(node)) {
      home.container = node;
    } else {
      home.others.push_back(node);
    }
  }
  return home.container.empty() ? std::nullopt : std::optional(home);
}

std::vector<std::string> ComponentContainers::nodes_in(const std::set<int>& processes) const {
  std::vector<std::string> nodes;
  for (const auto& [node, process] : processes_) {
    if (processes.contains(process)) nodes.push_back(node);
  }
  return nodes;
}

std::vector<ComponentId> ComponentContainers::end_with(ComponentId component,
                                                       bool ends_group) const {
  const auto last = last_.find(component);
  if (last == last_.end() || last->second == 0) return {};
  const pid_t group = ends_group ? getpgid(last->second) : -1;
  std::vector<ComponentId> others;
  for (const auto& [other, process] : last_) {
    const auto is_there = processes_.find(binding_.node_of(other));
    if (other == component || process == 0 || is_there == processes_.end() ||
        is_there->second != process)
      continue;
    if (process == last->second || (group > 0 && getpgid(process) == group))
      others.push_back(other);
  }
  return others;
}

std::optional<ComponentId> ComponentContainers::would_lose(ComponentId component) const {
  const auto last = last_.find(component);
  if (last == last_.end() || last->second == 0) return std::nullopt;
  if (containers_.contains(binding_.node_of(component))) return std::nullopt;
  const Component& one = rules_[component];
  for (const auto& [other, process] : last_) {
    const Component& another = rules_[other];
    const auto is_there = processes_.find(binding_.node_of(other));
    if (other == component || process != last->second || is_there == processes_.end() ||
        is_there->second != process)
      continue;
    const bool is_same = !one.launch.empty() && one.launch == another.launch;
    const bool are_respawned = one.is_respawned && another.is_respawned;
    if (another.can_start_again() && !is_same && !are_respawned) return other;
  }
  return std::nullopt;
}

}  // namespace culprit::owners
