// A strategy that may not be begun makes room for the next best.
#pragma once

#include "plan/planner.h"

namespace culprit::plan {

// Plans until nothing that is chosen is withheld. `withholds(strategy)` says whether the strategy
// may not be begun although others may, and then marks it in `knowledge` (Knowledge::withheld).
template <class Withholds>
std::vector<Decision> allowed(const Planner& planner, std::span<const RuleId> failures,
                              const Knowledge& knowledge, const Withholds& withholds) {
  while (true) {
    std::vector<Decision> decisions = planner.plan(failures, knowledge);
    bool is_any_withheld = false;
    for (const Decision& decision : decisions)
      is_any_withheld |= decision.chosen && withholds(*decision.chosen);
    if (!is_any_withheld) return decisions;
  }
}

}  // namespace culprit::plan
