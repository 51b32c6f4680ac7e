#include "base/live_clock.h"

#include <chrono>

namespace culprit {

Time live_now() {
  const auto now = std::chrono::steady_clock::now();
  return Time(std::chrono::duration_cast<Duration>(now.time_since_epoch()));
}

std::int64_t wall_now() {
  const auto now = std::chrono::system_clock::now();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
}

}  // namespace culprit
