// The call that examines the robot without rules (docs/doctor.md).
#pragma once

#include <functional>

#include "base/time.h"
#include "http/routes.h"

namespace culprit::web {

// Examines a robot for this time; returns what `culprit doctor --json` prints. Errors: it cannot be examined.
using Doctor = std::function<Expected<Json>(Duration time)>;

// One examination runs at a time: each joins the robot's network.
std::vector<Route> doctor_routes(Doctor doctor);

// Examines the robot of the environment (ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY).
Expected<Json> examine_robot(Duration time);

}  // namespace culprit::web
