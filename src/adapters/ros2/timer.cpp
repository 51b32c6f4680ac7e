#include "ros2/timer.h"

#include <utility>

#include "base/invariant.h"

namespace culprit::ros2 {

Timer::Timer(Executor& executor, Duration period, std::function<void()> callback)
    : period_(period),
      callback_(std::move(callback)),
      next_(Executor::Clock::now() + period),
      tasks_(executor) {
  CULPRIT_ASSERT(period > Duration::zero());
  tasks_.post_at(next_, [this] { tick(); });
}

void Timer::tick() {
  callback_();
  const auto late = Executor::Clock::now() - next_;
  next_ += (late / period_ + 1) * period_;
  tasks_.post_at(next_, [this] { tick(); });
}

}  // namespace culprit::ros2
