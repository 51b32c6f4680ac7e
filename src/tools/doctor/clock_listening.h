// Hears /clock.
#pragma once

#include <memory>
#include <optional>

#include "base/mutex.h"
#include "doctor/picture.h"
#include "ros2/subscription.h"

namespace culprit::doctor {

class ClockListening {
 public:
  // `self` outlives it.
  explicit ClockListening(ros2::NodeEntry& self) : self_(self) {}

  // On the executor's thread.
  void listen();
  void begin_anew();

  // The published time; empty without a publisher. From any thread, as the next.
  std::optional<Duration> now() const;
  std::optional<SimulatedClock> seen() const;

 private:
  void on_sample(const ros2::Sample& sample);

  ros2::NodeEntry& self_;
  mutable Mutex mutex_;
  std::optional<SimulatedClock> seen_ CULPRIT_GUARDED_BY(mutex_);
  std::unique_ptr<ros2::RawSubscription> subscription_;
};

}  // namespace culprit::doctor
