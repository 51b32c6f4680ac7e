// The cost of a strategy in the reference manager.
//
//     public code:  0.5 (1 - P) + 0.5 (i - 1) / N        paper (Eq. 1):  (1 - P) + i / i_max
//
// i is the sum of the impacts of the strategy's adaptations in the public code, and their maximum
// in the paper (plan/cost.h). N was to be the impact of a redeploy, but a misplaced "- 1" makes it
// that of a restart. Without S both are 1 - P (the public code writes it in percent).
#pragma once

#include <vector>

#include "language/rule_set.h"
#include "reference/options.h"

namespace culprit::study::reference {

class Costs {
 public:
  Costs(const RuleSet& rules, const ReferenceOptions& options);

  // `success` is P of the strategy.
  double operator()(StrategyId strategy, Probability success) const;

 private:
  bool with_impact_;
  std::vector<Cycles> impacts_;  // by strategy
};

}  // namespace culprit::study::reference
