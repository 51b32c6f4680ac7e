// How suspicious is it that a topic sends nothing? The phi-accrual failure detector (Hayashibara et al., SRDS
// 2004).
//
//     phi(t) = -log10 P(an interval longer than t),   intervals ~ Normal(mean, sd) of the last ones
//
// phi 1: one in ten intervals is as long as this gap; phi 8: one in a hundred million. It
// adapts itself to the topic's rhythm, so one threshold fits a 100 Hz lidar and a 1 Hz battery
// monitor alike.
#pragma once

#include <cstdint>
#include <optional>

#include "base/time.h"
#include "monitor/long_queue.h"

namespace culprit::monitor {

class PhiAccrual {
 public:
  static constexpr std::size_t kHistory = 128;
  // With fewer intervals there is no rhythm to speak of, and phi is unknown.
  static constexpr std::size_t kLeastIntervals = 5;
  // A machine is never as regular as its clock: the standard deviation is at least this share of
  // the mean.
  static constexpr double kLeastDeviation = 0.25;
  // A gap this suspicious is an outage and not part of the rhythm, unless it happens again and
  // again.
  static constexpr double kOutage = 8;
  static constexpr int kNewRhythm = 3;

  // `count` messages came at `at`, evenly spread since the last ones. Times never go back.
  void add(Time at, std::uint32_t count);

  // culprit could not listen for a while: until `until` the gap counts as `silence`, and then goes on. Its length is no
  // sample.
  void restart(Time until, Duration silence);

  // Empty while the rhythm is unknown.
  std::optional<double> phi(Time now) const;

  // How many standard deviations beyond the mean an interval is whose phi is `phi`.
  static double deviations(double phi);
  // When the gap will be longer than that, if nothing comes. kNever while the rhythm is
  // unknown.
  Time exceeds(double deviations) const;

 private:
  double deviation() const;

  LongQueue<double> intervals_{kHistory};  // seconds
  double mean_ = 0;
  double variance_ = 0;
  std::optional<Time> last_;
  Time excused_ = kLongAgo;  // until then the gap does not grow
  int outages_ = 0;          // in a row
  bool is_restarted_ = false;
};

}  // namespace culprit::monitor
