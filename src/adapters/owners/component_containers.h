// Finds the components that live in a component container (rclcpp_components): one process with
// many nodes, of which one loads the others. To end that process is to end them all.
//
// A node in one process with others is nothing of the kind by itself: many programs make several
// nodes, and start with all of them again.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "language/rule_set.h"
#include "robot/component_binding.h"
#include "robot/observation.h"

namespace culprit::owners {

class ComponentContainers {
 public:
  explicit ComponentContainers(const RuleSet& rules) : rules_(rules), binding_(rules) {}

  void observe(const Observation& observation);

  struct Home {
    std::string container;            // the node that loads
    std::vector<std::string> others;  // that live there now, besides
  };
  // Where the component lives, or lived last if that is there still. Nothing: in a process of its
  // own, or the process is not known, or it is the container.
  std::optional<Home> home_of(ComponentId component) const;

  // The nodes of these processes that are there, by full name.
  std::vector<std::string> nodes_in(const std::set<int>& processes) const;

  // The other components whose nodes are there and end with the component's process: they live in
  // it, or, if `ends_group`, in the process group that it is in.
  std::vector<ComponentId> end_with(ComponentId component, bool ends_group) const;

  // Another component in the same process that would not come back with this one, for the rules start
  // it in another way. One that they do not start is taken for the same program's. Nothing: there is
  // none, or the component is the container that the others live in.
  std::optional<ComponentId> would_lose(ComponentId component) const;

 private:
  const RuleSet& rules_;
  ComponentBinding binding_;
  std::map<std::string, int> processes_;  // of the nodes of the graph; 0: not known
  std::set<std::string> containers_;      // among them
  std::map<ComponentId, int> last_;       // the last known process of each; 0: not known
};

}  // namespace culprit::owners
