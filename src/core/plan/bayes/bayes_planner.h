// culprit's own planner: decides which component is responsible, which strategies may help, what
// each is worth, and which go together (docs/planning.md, and the headers beside this one).
//
// Strategies that only replace processes that are known to be dead are chosen first, and wait for no
// other failure (diagnose/known_down.h). Then, for each criticality level (inherited,
// plan/bayes/levels.h), from ERROR down, the strategies are chosen that have the highest total worth
// (value minus expected cost) and do not conflict: one for each failure, and no two that adapt a
// component or one and another that depends on it. Workarounds come last, beside the repair of their
// cause. Left out beforehand is a strategy that
//   1. was tried already, or
//   2. is invalid in the present state of the system (its WHEN condition is not true, ...),
//   3. adapts a component that is being adapted, or one that depends on such a component,
//   4. is for a failure that is more likely the effect of another one (1 - R_i > 1/2),
//   5. is for a failure that may be the echo of one that cleared a moment ago,
//   6. is for a failure whose cause can still be detected (diagnose/awaited.h), or that already looks
//      bad upstream (diagnose/imminent.h),
//   7. is for a failure that repeatedly began together with another one that has its turn now, or is
//      about to fire,
//   8. adapts a component on which a more critical failure depends that is being worked on and that
//      it does not explain: the lower criticality never delays the higher. A failure that waits for
//      a person is not being worked on (its cause is exhausted, or all that is left was refused).
// Every failure has its turn: 5 and 6 are waits of bounded length, and 3, 4, 7 and 8 wait for
// failures that end (resolved or exhausted) without waiting for this one.
//
// A strategy that took effect and only waits for its verdict stands less in the way. At a lower
// level, it does not hold back more critical strategies downstream. At a higher level, it does not
// hold back strategies upstream that take nothing down.
//
// Equal worths go by the names of rule and strategy, so that a decision does not depend on the
// order of declarations.
#pragma once

#include "plan/bayes/objective.h"
#include "plan/planner.h"

namespace culprit {

class BayesPlanner : public Planner {
 public:
  // How many suspects a decision names.
  static constexpr std::size_t kSuspects = 5;

  explicit BayesPlanner(Objective objective = Objective::kBalanced)
      : weights_(weights(objective)) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  CostWeights weights_;
};

}  // namespace culprit
