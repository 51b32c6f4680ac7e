#include "plan/bayes/bayes_planner.h"

#include "plan/bayes/planning_step.h"

namespace culprit {

std::vector<Decision> BayesPlanner::plan(std::span<const RuleId> failures,
                                         const Knowledge& knowledge) const {
  if (failures.empty()) return {};
  return plan::PlanningStep(failures, knowledge, weights_).run();
}

}  // namespace culprit
