// How many messages came within the last `window`, exactly.
//
// Each arrival is kept until it leaves the window, with how many messages had come by then: so the
// count, and the arrival with which it will fall below a number, are found without adding up.
#pragma once

#include <cstdint>

#include "base/invariant.h"
#include "base/time.h"
#include "language/rule_set.h"
#include "monitor/long_queue.h"

namespace culprit::monitor {

class SlidingCount {
 public:
  // Keeps `limit` arrivals at different times at most; 16 bytes each. @pre window > 0, limit > 0
  explicit SlidingCount(Duration window, std::size_t limit = kMaxWindowSamples)
      : window_(window), arrivals_(limit) {
    CULPRIT_ASSERT(window > Duration::zero());
  }

  // `count` messages came at `at`. Times never go back. False: the window would hold more arrivals
  // than `limit`. Then the count begins anew with these messages.
  [[nodiscard]] bool add(Time at, std::uint32_t count);

  // Forgets what is older than the window at `now`. A message leaves the window when it is exactly
  // as old as it.
  void advance(Time now);

  std::uint64_t count() const { return total_ - left_; }
  double rate() const { return static_cast<double>(count()) / seconds(window_); }

  // When the count will first fall below `wanted`, if nothing more comes. kNever if it is below
  // now.
  Time falls_below(std::uint64_t wanted) const;

 private:
  struct Arrivals {
    Time at;
    std::uint64_t total = 0;  // messages up to these, since the beginning
  };
  Duration window_;
  LongQueue<Arrivals> arrivals_;
  std::uint64_t total_ = 0;  // messages that came
  std::uint64_t left_ = 0;   // messages that left the window
};

}  // namespace culprit::monitor
