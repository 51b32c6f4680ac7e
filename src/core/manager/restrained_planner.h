// A planner that chooses what a manager would begin: a strategy that the governor withholds because
// of the robot's state (several nodes of one name, evidence) makes room for the next best.
//
// It answers questions about decisions (culprit plan, what-if). Budgets and back-offs do not count
// here, because they come from earlier actions.
#pragma once

#include "plan/planner.h"

namespace culprit {

class RestrainedPlanner : public Planner {
 public:
  // `planner` must outlive this one.
  explicit RestrainedPlanner(const Planner& planner) : planner_(planner) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  const Planner& planner_;
};

}  // namespace culprit
