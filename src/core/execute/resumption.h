// How to go on with a strategy that an earlier process of culprit did not live to end.
//
// Nothing is asked for twice that may have been carried out already and does harm then: states are
// looked at first, an increase is brought to the value it was meant to reach, a process is started
// only if no other one is there, and a routine of which nobody knows whether it ran is not called
// again.
#pragma once

#include <string>
#include <vector>

#include "execute/goal.h"
#include "knowledge/interrupted.h"

namespace culprit::execute {

struct Resumption {
  std::size_t adaptation = 0;  // to go on with
  std::vector<Goal> goals;     // what is left of it; empty: all of it
  std::string obstacle;        // why it cannot be finished; empty: it can
};

Resumption resumption_of(const Interrupted& interrupted, const Knowledge& knowledge);

// What has to be brought back if the strategy does not help, in the order in which it was changed.
struct Undo {
  ComponentId component;
  Goal goal;
};
std::vector<Undo> undo_of(const Interrupted& interrupted, const Knowledge& knowledge);

}  // namespace culprit::execute
