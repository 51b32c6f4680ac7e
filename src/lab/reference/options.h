// How the reference manager behaves.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "base/time.h"
#include "base/value.h"
#include "plan/paper_planner.h"

namespace culprit::study {

struct ReferenceOptions {
  // S as in the paper. D alone holds back only what depends on a component that was just chosen; C
  // without D does nothing, in the public code.
  PaperSwitches switches;

  Time start{};            // of the first tick; the others follow, one each CYCLE of the rules
  Time graph_frozen_at{};  // the first tick from here on takes the snapshot

  // The blackboard's initial value of each signal of the rules, before its first reading.
  std::map<std::string, Value> initial;

  // Strategies of equal cost go in the order of a hash set of addresses (reference/sent_rules.h);
  // the seed deals the addresses. 0: none collide, so that the failure detected last goes first.
  std::uint64_t seed = 0;
};

}  // namespace culprit::study
