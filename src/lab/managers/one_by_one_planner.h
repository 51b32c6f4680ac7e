// How managers plan that know one failure at a time and one strategy for each: a behaviour tree's
// branch, an objective's design, an action's function. The failure that is first in the rule file
// comes first, its likeliest strategy is executed, over and over, and whatever else is wrong waits.
#pragma once

#include "plan/planner.h"

namespace culprit::study {

class OneByOnePlanner : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;
};

}  // namespace culprit::study
