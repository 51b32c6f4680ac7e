// Upstream of whom are there rules that may have been too slow?
//
// Of a bad value nothing is seen beforehand. If a rule about values watches something upstream of a
// failure, it may be about to fire; not if nothing new will be heard of it in the time that anybody
// would wait.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

class Watchers {
 public:
  // One pass over the graph. It must outlive this. Nobody waits longer than `until`.
  Watchers(const Knowledge& knowledge, Time until);

  // Does another rule about values touch something upstream?
  bool are_upstream_of(RuleId failure) const;

 private:
  struct Place {
    std::size_t components = 0;  // more than one: a circle
    std::size_t rules = 0;       // that touch it and may be about to fire
    bool is_below_one = false;   // of those upstream of it
  };

  const Knowledge& knowledge_;
  std::vector<Place> places_;  // by SCC
};

}  // namespace culprit::plan
