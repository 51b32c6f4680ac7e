// Lets a simulated world live by the clock: what is due in robot time is done when that time has
// come on the wall. So the nodes of the model run in real processes as they are.
#pragma once

#include <functional>

#include "exemplars/suave/live_names.h"
#include "ros2/timer.h"
#include "simulation/world.h"

namespace culprit::suave {

class PacedWorld {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds(100);  // of robot time, for most

  // From `world.now()` on. Calls `after` each time that the world was brought up to date, every
  // `tick` of robot time. All must outlive it.
  PacedWorld(
      ros2::Executor& executor, simulation::World& world, const NodeOptions& options, Duration tick,
      std::function<void()> after = [] {});

  // Does what is due by now.
  void catch_up();

 private:
  simulation::World& world_;
  const double speed_;
  const std::function<void()> after_;
  const Time begin_;
  const ros2::Executor::Clock::time_point wall_begin_;
  ros2::Timer timer_;
};

}  // namespace culprit::suave
