// Mean, least, greatest value or standard deviation of a signal over the last `window`, exactly.
//
// A window counts only once it is covered: known from when samples came for all of its length. A
// stretch of more than `longest_pause` without a sample is a gap; the window is covered anew from the
// first sample after it. Adding a sample takes constant time on average, and never long.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "base/time.h"
#include "language/rule_set.h"
#include "monitor/sliding_extreme.h"
#include "monitor/sliding_moments.h"

namespace culprit::monitor {

class ValueWindow {
 public:
  enum class Of : std::uint8_t { kMean, kMin, kMax, kStddev };

  // Keeps `limit` samples at most; 16 bytes each.
  // @pre window > 0, longest_pause > 0, limit > 0
  ValueWindow(Of of, Duration window, Duration longest_pause,
              std::size_t limit = kMaxWindowSamples);

  // Times never go back. False: there are more samples than `limit`. Then the window is covered anew
  // from this sample on. @pre value is a number
  [[nodiscard]] bool add(Time at, double value);

  // Forgets all: the window is covered anew from the next sample on.
  void begin_anew();

  // As of `now`, which never goes back. Empty: it is not covered, or has no sample. NaN where
  // infinite samples leave no result.
  std::optional<double> value(Time now);

  // When value() will give something else if no sample comes; kNever: not before one comes.
  // @pre value(now) was the last call
  Time next_change(Time now) const;

 private:
  bool is_covered(Time now) const;

  Duration window_;
  Duration longest_pause_;
  std::optional<Time> since_;  // the first sample since the last gap
  Time last_;                  // the last one, if there is a first
  std::variant<SlidingMoments, SlidingExtreme> values_;
};

}  // namespace culprit::monitor
