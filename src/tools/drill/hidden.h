// Dependencies that the graph of the robot does not show: a service, a shared port, a file.
//
// A component needs another one if it fell silent in every trial of one fault of that one, in three trials at least. The drill
// chooses at random which component to break, so nothing else is the cause. Silence that may be chance does not count, nor
// does that of a component which falls silent in most faults.
//
//     hidden_dependencies(trials, paths)    // {{"planner", "map_writer", 5}}
#pragma once

#include <string>
#include <vector>

#include "drill/trial.h"

namespace culprit::drill {

struct HiddenDependency {
  std::string consumer;
  std::string producer;
  int times = 0;  // in as many faults of the producer
};

// `paths`: over the edges that the graph shows. A dependency that follows from the others and the graph is not among them.
std::vector<HiddenDependency> hidden_dependencies(const std::vector<Trial>& trials,
                                                  const Paths& paths);

}  // namespace culprit::drill
