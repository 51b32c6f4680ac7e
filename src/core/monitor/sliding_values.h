// Mean, extremes and spread of a signal over the last `window`.
#pragma once

#include <cassert>
#include <optional>

#include "base/time.h"
#include "monitor/ring.h"

namespace culprit::monitor {

class SlidingValues {
 public:
  // More values than this within one window push the oldest out before their time.
  static constexpr std::size_t kMaxValues = 4096;

  // @pre window > 0
  explicit SlidingValues(Duration window) : window_(window) { assert(window > Duration::zero()); }

  void add(Time at, double value);
  // Forgets what is older than the window at `now`.
  void advance(Time now);
  // When the oldest value leaves the window.
  Time next_change() const;

  struct Summary {
    double mean = 0;
    double min = 0;
    double max = 0;
    double stddev = 0;  // of the population
  };
  // Nothing if the window is empty.
  std::optional<Summary> summary() const;

 private:
  struct Sample {
    Time at;
    double value = 0;
  };
  Duration window_;
  Ring<Sample> samples_{kMaxValues};
};

}  // namespace culprit::monitor
