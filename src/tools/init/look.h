// Watches a robot for as long as a draft of its rules needs. Changes nothing.
#pragma once

#include "init/robot_profile.h"
#include "link/survey.h"

namespace culprit::init {

// Watches all topics but those of ROS itself and asks all nodes, for `time`; that costs the robot's
// network one subscriber more for each topic. `domain` is the survey's. The calling thread waits.
RobotProfile look(link::Survey& survey, std::uint32_t domain, Duration time);

}  // namespace culprit::init
