// How often something comes, and how soon it would therefore show a change.
#pragma once

#include <algorithm>
#include <chrono>

#include "base/units.h"

namespace culprit::monitor {

// A topic with a longer interval shows little about how fast it would show a change.
constexpr Duration kLongestLatency = std::chrono::seconds(5);
// A signal that regularly comes at longer intervals shows a change within two of them, at most this.
constexpr Duration kLongestOfSeldom = std::chrono::seconds(20);

// A new interval counts for an eighth, as in TCP's round-trip estimate.
inline Duration smoothed(Duration before, Duration now) {
  return before == Duration::zero() ? now : before + (now - before) / 8;
}

// The usual pause between two samples: a topic that comes in bursts pauses longer than its average
// interval. A longer pause counts at once, but no outage is taken for a pause; a shorter one counts
// for an eighth.
inline Duration usual_gap(Duration before, Duration now) {
  return now > before && before > Duration::zero() ? std::min(now, 2 * before)
                                                   : smoothed(before, now);
}

inline Duration usual_latency(Duration interval) { return std::min(2 * interval, kLongestLatency); }

}  // namespace culprit::monitor
