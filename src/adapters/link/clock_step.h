// Whether the system clock of this computer was stepped: set back, or ahead, by more than an adjustment.
//
// culprit measures by a clock that cannot be set, but nodes may not: after the system clock is set
// back, timers of rclpy, and all code that waits for a time of day, stand still until it has caught
// up.
#pragma once

#include <optional>

#include "base/time.h"

namespace culprit::link {

class ClockStep {
 public:
  // NTP slews smaller differences.
  static constexpr Duration kLeast = std::chrono::seconds(1);

  // `steady`: a clock that cannot be set and that goes on while the computer sleeps; `wall`: the
  // system clock at the same time. By how much that was set since the last call; nothing: it was
  // not.
  std::optional<Duration> look(Duration steady, Duration wall) {
    const Duration offset = wall - steady;
    const Duration before = offset_.value_or(offset);
    offset_ = offset;
    const Duration step = offset - before;
    return std::chrono::abs(step) >= kLeast ? std::optional(step) : std::nullopt;
  }

 private:
  std::optional<Duration> offset_;
};

}  // namespace culprit::link
