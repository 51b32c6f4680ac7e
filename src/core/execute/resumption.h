// How to go on with a strategy that an earlier process of culprit did not live to end.
//
// No request is repeated that may have been carried out already and would do harm the second time.
// States are looked at first; an increase is brought to the value that it was meant to reach; a
// process is started only if no other one is there. A routine is not called again if it may have
// run.
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

// A goal that undoes a change if the strategy does not help. Undos are kept in the order of the
// changes.
struct Undo {
  ComponentId component;
  Goal goal;
};
std::vector<Undo> undo_of(const Interrupted& interrupted, const Knowledge& knowledge);

}  // namespace culprit::execute
