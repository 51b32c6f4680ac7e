// The paper's planner: Algorithm 1 with its five conditions and Equation 1.
//
// For each criticality level, from ERROR down, the strategies of all failures are sorted by cost,
// and each is chosen that
//   1. was not tried yet,
//   2. is valid in the present state of the system,
//   3. adapts no component that is being adapted already,
//   4. adapts no component that a strategy chosen in this plan adapts,
//   5. adapts no component that depends on another one that may be the cause of a failure of the
//   same or a higher level;
// and at most one for each failure. Where the printed algorithm slips (its inner `break` leaves
// only the loop over the nodes, so that the strategy is chosen all the same) this follows the text:
// a strategy that fails a condition is skipped. A failure does not exclude its own strategies by
// condition 5: it is no other cause.
//
// The three factors can be switched off, as in the paper's ablation:
//   D  dependencies: without, condition 5 does not exist;
//   C  criticality:  without, all failures are of one level;
//   S  impact:       without, the cost is only the chance to fail.
//
// An exhausted failure may still be the cause (condition 5) while its trigger is true: what depends
// on it waits for a person, and only what plan/beside_exhausted.h names may be tried.
//
// Equal costs go by the names of rule and strategy, so that a decision does not depend on the order
// of declarations.
#pragma once

#include <cstdint>

#include "plan/planner.h"

namespace culprit {

struct PaperSwitches {
  bool dependencies = true;
  bool criticality = true;
  bool impact = true;

  bool operator==(const PaperSwitches&) const = default;
};

class PaperPlanner : public Planner {
 public:
  explicit PaperPlanner(PaperSwitches switches = {}) : switches_(switches) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  // A strategy of a failure.
  struct Option {
    StrategyId strategy;
    double cost = 0;
    std::size_t failure = 0;  // index among the failures
    std::int64_t parts = 0;   // of the cost (plan/ties.h)
    std::size_t rank = 0;     // of the failure, by the rule's name
  };

  double cost(const Strategy& strategy, StrategyId id, const Knowledge& knowledge) const;
  void select(std::span<const RuleId> failures, Criticality level, const Knowledge& knowledge,
              std::vector<ComponentId>& affected, std::vector<Decision>& decisions) const;
  std::vector<Option> cheapest_first(std::span<const RuleId> failures,
                                     const Knowledge& knowledge) const;
  // `decision` has the cheaper strategies of the same failure.
  void examine(Candidate& candidate, Criticality level, const Knowledge& knowledge,
               const std::vector<ComponentId>& affected, const Decision& decision) const;
  bool depends_like_another(Candidate& candidate, const Decision& decision,
                            const Knowledge& knowledge) const;
  bool depends_on_cause(Candidate& candidate, Criticality level, const Knowledge& knowledge) const;

  PaperSwitches switches_;
};

}  // namespace culprit
