// How many messages came within the last `window`, exactly.
#pragma once

#include <cassert>
#include <cstdint>

#include "base/time.h"
#include "monitor/ring.h"

namespace culprit::monitor {

class SlidingCount {
 public:
  // More arrivals than this within one window are counted with the newest of them: the count stays
  // exact, and they leave the window a moment late.
  static constexpr std::size_t kMaxArrivals = 1 << 14;

  // @pre window > 0
  explicit SlidingCount(Duration window) : window_(window) { assert(window > Duration::zero()); }

  // `count` messages came at `at`. Times never go back.
  void add(Time at, std::uint32_t count);

  // Forgets what is older than the window at `now`. A message leaves the window when it is exactly
  // as old as it.
  void advance(Time now);

  std::uint64_t count() const { return count_; }
  double rate() const { return static_cast<double>(count_) / seconds(window_); }

  // When the count will first fall below `wanted`, if nothing more comes. kNever if it is below
  // now.
  Time falls_below(std::uint64_t wanted) const;

 private:
  struct Arrivals {
    Time at;
    std::uint64_t count = 0;
  };
  Duration window_;
  Ring<Arrivals> arrivals_{kMaxArrivals};
  std::uint64_t count_ = 0;
};

}  // namespace culprit::monitor
