// Which failures may have a cause that a slower rule is about to detect?
//
// A bad value gives no warning before it is there. If a rule about values watches something
// upstream of a failure, it may be about to fire, unless no new value will arrive within the time
// that a plan is prepared to wait.
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
