// The one clock of a managed robot: wall time for a live robot, virtual time for a simulated one,
// recorded time for a bag.
//
// The core never reads a clock. It gets the time from Observation::at and from the `now` of a step.
#pragma once

#include <chrono>

#include "base/units.h"

namespace culprit {

struct RobotClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<RobotClock>;
  static constexpr bool is_steady = true;
};

using Time = RobotClock::time_point;

inline constexpr Time kNever = Time::max();
inline constexpr Time kLongAgo = Time::min();

// Saturating: kNever stays kNever, and nothing overflows.
constexpr Time later(Time t, Duration d) {
  return d > Duration::zero() && t > kNever - d ? kNever : t + d;
}

}  // namespace culprit
