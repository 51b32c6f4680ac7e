// Which components have something to do with each other? Those that are connected in the graph, in whatever
// direction. No decision about one part depends on another part. Strategies that end a common process are
// never begun together (exclusions.h).
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

class ConnectedParts {
 public:
  // The parts of the graph as it is now. Takes time in proportion to its size.
  explicit ConnectedParts(const Knowledge& knowledge);

  // One strategy adapts them all.
  void connect(const std::vector<ComponentId>& components);
  // The same number for all components of a part.
  std::size_t of(ComponentId component) { return root(place_of(component)); }

 private:
  std::size_t place_of(ComponentId component) const;
  std::size_t root(std::size_t place);
  void connect(std::size_t a, std::size_t b) { parents_[root(a)] = root(b); }

  const Knowledge& knowledge_;
  // A forest with a tree for each part: of the SCCs of the graph, and of the components that are not in it.
  std::vector<std::size_t> parents_;
};

}  // namespace culprit::plan
