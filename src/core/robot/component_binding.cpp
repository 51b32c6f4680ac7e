#include "robot/component_binding.h"

namespace culprit {

ComponentBinding::ComponentBinding(const RuleSet& rules) {
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const Component& component = rules.components[c];
    nodes_.push_back(component.node);
    others_.push_back(component.other_nodes);
    for (const std::string& other : component.other_nodes)
      components_.emplace(other, ComponentId(c));
    if (component.node.empty()) {
      without_node_.emplace(component.name, ComponentId(c));
    } else {
      components_.emplace(component.node, ComponentId(c));
    }
  }
  namesakes_.resize(nodes_.size());
}

std::optional<ComponentId> ComponentBinding::find(const std::string& node) const {
  const auto known = components_.find(node);
  return known == components_.end() ? std::nullopt : std::optional(known->second);
}

std::optional<ComponentId> ComponentBinding::bind(const std::string& node) {
  if (const auto known = find(node)) return known;
  const auto fitting = without_node_.find(node.substr(node.rfind('/') + 1));
  if (fitting == without_node_.end()) return std::nullopt;
  const ComponentId component = fitting->second;
  std::string& bound = nodes_[component.index];
  if (!bound.empty()) {
    namesakes_[component.index] = node;
    return std::nullopt;
  }
  components_.emplace(node, component);
  bound = node;
  return component;
}

std::string ComponentBinding::ambiguity(ComponentId component) const {
  const std::string& other = namesakes_[component.index];
  if (other.empty()) return "";
  const std::string& bound = nodes_[component.index];
  return "it could be " + bound + " or " + other + ": say which with NODE " + bound;
}

}  // namespace culprit
