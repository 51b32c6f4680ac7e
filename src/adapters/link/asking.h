// A question to a node that was just discovered, asked again until it is answered: while the node loads (a model, slow
// imports), it may answer nothing.
#pragma once

#include <atomic>

#include "ros2/service_client.h"

namespace culprit::link {

// begin() and is_due() on the executor's thread; asks() and ends() on any.
class Asking {
 public:
  static constexpr int kMost = 60;  // of 5 s each

  // The node was discovered: from now on it counts.
  void begin() { left_ = kMost; }
  void asks() { ++under_way_; }
  void ends(const ros2::CallResult& result) {
    if (result.outcome == ros2::CallOutcome::kTimedOut) is_open_ = true;
    --under_way_;
  }
  // Once for each time that it was left unanswered.
  bool is_due() { return under_way_ == 0 && is_open_.exchange(false) && left_-- > 0; }

 private:
  std::atomic<int> under_way_ = 0;
  std::atomic<bool> is_open_ = false;
  int left_ = 0;  // of the executor's thread
};

}  // namespace culprit::link
