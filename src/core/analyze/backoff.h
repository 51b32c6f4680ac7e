// How long a rule pauses between two rounds of its strategies.
#pragma once

#include <algorithm>

#include "base/time.h"

namespace culprit {

inline constexpr Duration kFirstBackoff = std::chrono::seconds(1);
inline constexpr Duration kLongestBackoff = std::chrono::seconds(60);

// After so many rounds, at least one: doubled each time.
inline Duration pause_after(int rounds) {
  const int doublings = std::min(rounds - 1, 10);
  return std::min<Duration>(kFirstBackoff * (1 << doublings), kLongestBackoff);
}

}  // namespace culprit
