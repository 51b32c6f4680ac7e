// Which component a node of the graph is.
//
// A component with a NODE is that node. One without is the first node seen whose own name
// ("/ns/camera": camera) is the component's.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "language/rule_set.h"

namespace culprit {

class ComponentBinding {
 public:
  explicit ComponentBinding(const RuleSet& rules);

  // Binds a component that has no node yet, if `node` fits it.
  std::optional<ComponentId> bind(const std::string& node);

  // The full name of the component's node; empty while it has none.
  const std::string& node_of(ComponentId component) const { return nodes_[component.index]; }

 private:
  std::vector<std::string> nodes_;                             // by component
  std::unordered_map<std::string, ComponentId> components_;    // by full node name
  std::unordered_map<std::string, ComponentId> without_node_;  // by component name
};

}  // namespace culprit
