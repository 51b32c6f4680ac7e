// The call that has the robot examined: what is wrong with it, without a rule (docs/doctor.md).
#pragma once

#include <functional>

#include "base/time.h"
#include "http/routes.h"

namespace culprit::web {

// Looks at a robot for so long; gives what `culprit doctor --json` prints. Errors: it cannot be looked at.
using Doctor = std::function<Expected<Json>(Duration time)>;

// One examination runs at a time: each joins the robot's network.
std::vector<Route> doctor_routes(Doctor doctor);

// Examines the robot of the environment (ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY).
Expected<Json> examine_robot(Duration time);

}  // namespace culprit::web
