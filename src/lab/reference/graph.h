// The reference manager's dependencies of the managed system.
//
// As in the public code, a subscriber depends on the publishers of its topic in its own namespace
// only (topics are compared with the namespace of the node in front of them). A server depends on
// its clients. After the snapshot the graph stays as it is.
#pragma once

#include "knowledge/dependency_graph.h"
#include "reference/options.h"

namespace culprit::study::reference {

class Graph {
 public:
  // `rules` must outlive the graph.
  Graph(const RuleSet& rules, const ReferenceOptions& options);

  void take_in(const Observation& observation);

  // A tick of the manager begins: is it time for the snapshot?
  void tick(Time now);

  // All components that `component` depends on, transitively. Valid until the next call.
  const std::vector<ComponentId>& upstream(ComponentId component) const {
    return graph_.upstream(component);
  }

 private:
  DependencyGraph graph_;
  Time frozen_at_;
  bool is_frozen_ = false;
};

}  // namespace culprit::study::reference
