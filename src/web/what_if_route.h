// The call that asks what would be decided for a state of the robot (docs/plan.md).
#pragma once

#include "http/routes.h"
#include "language/reuse/expansion.h"
#include "plan/planner.h"

namespace culprit::web {

// Decides as `planner` does; it changes nothing and needs no robot.
// `load` finds what the rules include.
Route what_if_route(PlannerFactory planner, RuleLoader load = nullptr);

}  // namespace culprit::web
