// The call that asks what would be decided for a state of the robot (docs/plan.md).
#pragma once

#include "plan/planner.h"
#include "web/routes.h"

namespace culprit::cli {

// Decides as `planner` does; it changes nothing and needs no robot.
web::Route what_if_route(PlannerFactory planner);

}  // namespace culprit::cli
