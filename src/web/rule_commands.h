// Everything that a rule set has executed in culprit's name: programs, units, containers, plugins and service calls. The
// right to change a threshold does not include the right to run programs on the robot.
#pragma once

#include <string>
#include <vector>

#include "language/rule_set.h"

namespace culprit::web {

// A line for each, sorted: "camera LAUNCH ros2 run my_cameras driver", "R.reset call fusion ~/reset".
std::vector<std::string> commands_of(const RuleSet& rules);

}  // namespace culprit::web
