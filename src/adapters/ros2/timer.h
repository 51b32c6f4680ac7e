// Calls back periodically, by the steady clock, on the executor's thread.
//
// The first call comes after one period. Periods that passed while the thread was busy are left
// out; the rhythm stays. The callback may do anything but destroy the timer.
#pragma once

#include <functional>

#include "base/units.h"
#include "ros2/executor.h"

namespace culprit::ros2 {

class Timer {
 public:
  // @pre period > 0
  Timer(Executor& executor, Duration period, std::function<void()> callback);

 private:
  void tick();

  const Duration period_;
  const std::function<void()> callback_;
  Executor::Clock::time_point next_;
  TaskGroup tasks_;
};

}  // namespace culprit::ros2
