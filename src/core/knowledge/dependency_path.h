// The path that ties two nodes: the shortest one along the edges of the graph.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "knowledge/dependency_graph.h"

namespace culprit {

// The edges by which `consumer` depends on `producer`, directly or through others, the consumer's
// first: as few as possible, and of several ways the same one each time. Empty: it does not.
std::vector<DependencyGraph::Edge> dependency_path(std::span<const DependencyGraph::Edge> edges,
                                                   const std::string& consumer,
                                                   const std::string& producer);

}  // namespace culprit
