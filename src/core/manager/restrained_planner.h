// A planner that chooses what a manager would begin: what the governor withholds because of what it
// knows of the robot (several nodes of one name, evidence) makes room for the next best.
//
// For whoever asks what would be decided (culprit plan), and what if. Budgets and back-offs are not
// heard: they come from what was done before.
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
