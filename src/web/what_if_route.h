// The call that asks what would be decided for a state of the robot (docs/plan.md).
#pragma once

#include "plan/planner.h"
#include "web/routes.h"

namespace culprit::web {

// Decides as `planner` does; it changes nothing and needs no robot.
Route what_if_route(PlannerFactory planner);

}  // namespace culprit::web
