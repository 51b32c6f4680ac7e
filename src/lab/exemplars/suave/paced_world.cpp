#include "exemplars/suave/paced_world.h"

namespace culprit::suave {

PacedWorld::PacedWorld(ros2::Executor& executor, simulation::World& world,
                       const NodeOptions& options, Duration tick, std::function<void()> after)
    : world_(world),
      speed_(options.speed),
      after_(std::move(after)),
      begin_(world.now()),
      wall_begin_(ros2::Executor::Clock::now()),
      timer_(executor, options.wall(tick), [this] {
        catch_up();
        after_();
      }) {}

void PacedWorld::catch_up() {
  const Duration passed = ros2::Executor::Clock::now() - wall_begin_;
  world_.run(later(begin_, from_seconds(seconds(passed) * speed_)));
}

}  // namespace culprit::suave
