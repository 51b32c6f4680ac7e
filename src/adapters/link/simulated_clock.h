// Whether the clock of a simulated robot runs: /clock, which simulators and `ros2 bag play --clock`
// publish (use_sim_time, design.ros2.org/articles/clock_and_time.html).
//
// While it stands still, the robot does, too: nothing that is missing is missing on the robot. When
// it jumps, its nodes start over. How fast it runs is not looked at: ages stay in real
// time.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/expected.h"
#include "base/mutex.h"
#include "base/time.h"
#include "ros2/subscription.h"

namespace culprit::link {

class SimulatedClock {
 public:
  static constexpr const char* kTopic = "/clock";
  // A publisher with a rhythm of its own has three of its usual intervals, and at least this.
  static constexpr Duration kPatience = std::chrono::milliseconds(100);
  // However slow it is usually.
  static constexpr Duration kPatienceAtMost = std::chrono::seconds(2);
  // After a jump all nodes have so long to find their pace again.
  static constexpr Duration kAfterJump = std::chrono::seconds(1);
  // Back is a jump, and so is this much ahead at once, unless it is so many times real time.
  static constexpr Duration kJump = std::chrono::seconds(10);
  static constexpr int kFastest = 100;

  // `self` outlives it. An error when the middleware, or the domain's permissions, refuse.
  static Expected<std::unique_ptr<SimulatedClock>> open(ros2::NodeEntry& self);

  // Until when it is sure that it runs; in the past: it stands still. From any thread, as the next.
  Time doubtful(Time now) const;
  // Whether anybody has published it.
  bool has_begun() const;
  // The doubt, once that time has come.
  std::string doubt(Time now) const;

  // /clock shows `shown`, and `now` is the real time.
  void tick(Duration shown, Time now);

 private:
  bool has_just_jumped(Time now) const CULPRIT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::optional<Duration> shown_ CULPRIT_GUARDED_BY(mutex_);
  Time advanced_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  Time jumped_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  Duration usual_pause_ CULPRIT_GUARDED_BY(mutex_) = kPatience / 3;
  std::unique_ptr<ros2::RawSubscription> subscription_;
};

}  // namespace culprit::link
