#include "monitor/phi_accrual.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace culprit::monitor {
namespace {

// -log10 of the upper tail of the standard normal distribution.
double suspicion(double z) {
  constexpr double kFar =
      30;  // beyond, erfc is too small for a double; there the tail is exp(-z^2/2) / (z sqrt(2 pi))
  if (z < kFar) return -std::log10(0.5 * std::erfc(z / std::sqrt(2.0)));
  return (z * z / 2 + std::log(z * std::sqrt(2 * M_PI))) / M_LN10;
}

}  // namespace

double PhiAccrual::deviations(double phi) {
  double low = -10;
  double high = 10;
  while (suspicion(high) < phi && high < 1e6) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (suspicion(middle) < phi ? low : high) = middle;
  }
  return high;
}

void PhiAccrual::add(Time at, std::uint32_t count) {
  const std::optional<Time> before = last_;
  const std::optional<double> suspected = phi(at);
  last_ = at;
  excused_ = kLongAgo;
  if (std::exchange(is_restarted_, false) || !before || count == 0) return;
  outages_ = suspected && *suspected > kOutage ? outages_ + 1 : 0;
  if (outages_ > 0 && outages_ < kNewRhythm) return;
  if (outages_ == kNewRhythm) intervals_.clear();

  const double interval = seconds(at - *before) / count;
  if (intervals_.full()) intervals_.pop_front();
  intervals_.push_back(interval);
  double sum = 0;
  for (std::size_t i = 0; i < intervals_.size(); ++i) sum += intervals_[i];
  mean_ = sum / static_cast<double>(intervals_.size());
  double squares = 0;
  for (std::size_t i = 0; i < intervals_.size(); ++i)
    squares += (intervals_[i] - mean_) * (intervals_[i] - mean_);
  variance_ = squares / static_cast<double>(intervals_.size());
}

double PhiAccrual::deviation() const {
  return std::max({std::sqrt(variance_), kLeastDeviation * mean_, 1e-9});
}

void PhiAccrual::restart(Time until, Duration silence) {
  if (!last_) return;
  last_ = until - silence;
  excused_ = until;
  is_restarted_ = true;
}

std::optional<double> PhiAccrual::phi(Time now) const {
  if (!last_ || intervals_.size() < kLeastIntervals) return std::nullopt;
  return suspicion((seconds(std::max(now, excused_) - *last_) - mean_) / deviation());
}

Time PhiAccrual::exceeds(double deviations) const {
  if (!last_ || intervals_.size() < kLeastIntervals) return kNever;
  const double gap = mean_ + deviations * deviation();
  return later(*last_, from_seconds(std::max(gap, 0.0)) + Duration(1));
}

}  // namespace culprit::monitor
