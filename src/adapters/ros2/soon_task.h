// A task that is due once, however many changes ask for it before it runs: strangers decide how many there are.
#pragma once

#include <functional>
#include <utility>

#include "ros2/executor.h"

namespace culprit::ros2 {

// Used by the executor's thread only.
class SoonTask {
 public:
  // `tasks` outlives it, and is closed before it is destroyed.
  SoonTask(TaskGroup& tasks, std::function<void()> run) : tasks_(tasks), run_(std::move(run)) {}

  void post() {
    if (std::exchange(is_due_, true)) return;
    tasks_.post([this] {
      is_due_ = false;
      run_();
    });
  }

 private:
  TaskGroup& tasks_;
  const std::function<void()> run_;
  bool is_due_ = false;
};

}  // namespace culprit::ros2
