// Pure pursuit (Coulter, 1992): drive on the arc through a point that lies a little ahead on the path.
#pragma once

#include <functional>
#include <vector>

#include "exemplars/rover/geometry.h"

namespace culprit::rover {

struct Command {
  double speed = 0;
  double turn = 0;
};

// `path` and `robot` are in the same frame. `most` is the highest speed. A robot that looks away from the path turns first.
Command pursue(const std::vector<Pose2>& path, const Pose2& robot, double most);

// How far the robot could drive with a command until `is_occupied`, at most `longest` metres.
double free_length(const Pose2& robot, const Command& command, double longest,
                   const std::function<bool(const Pose2&)>& is_occupied);

}  // namespace culprit::rover
