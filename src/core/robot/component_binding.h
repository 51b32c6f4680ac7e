// Which component a node of the graph is.
//
// A component with a NODE is that node; one with several is all of them. One without is the first node seen whose own name
// ("/ns/camera": camera) is the component's; if a second such node shows up (/r1/camera, /r2/camera),
// it is unknown which of them is meant.
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

  // The component that is known to be this node. Binds none.
  std::optional<ComponentId> find(const std::string& node) const;

  // The full name of the component's node; empty while it has none.
  const std::string& node_of(ComponentId component) const { return nodes_[component.index]; }

  // Those that its process has besides.
  const std::vector<std::string>& other_nodes(ComponentId component) const {
    return others_[component.index];
  }
  bool has_several(ComponentId component) const { return !other_nodes(component).empty(); }

  // Why it is not sure which node the component is: both nodes, and what to write. Empty if it is.
  std::string ambiguity(ComponentId component) const;

 private:
  std::vector<std::string> nodes_;                             // by component
  std::vector<std::vector<std::string>> others_;               // likewise
  std::unordered_map<std::string, ComponentId> components_;    // by full node name
  std::unordered_map<std::string, ComponentId> without_node_;  // by component name
  std::vector<std::string> namesakes_;                         // by component: a second that fits
};

}  // namespace culprit
