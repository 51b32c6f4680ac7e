#include "monitor/sliding_moments.h"

#include <cmath>
#include <limits>

namespace culprit::monitor {

bool SlidingMoments::add(Time at, double value) {
  if (samples_.full()) return false;
  const Sum own{value, 0};
  newer_ = joined(newer_, samples_.size() - older_, own, 1);
  samples_.push_back({at, own});
  return true;
}

void SlidingMoments::forget_until(Time time) {
  while (!samples_.empty() && samples_.front().at <= time) {
    if (older_ == 0) turn_over();
    samples_.pop_front();
    --older_;
  }
}

void SlidingMoments::clear() {
  samples_.clear();
  older_ = 0;
  newer_ = {};
}

double SlidingMoments::value() const {
  const Sum older = older_ > 0 ? samples_.front().sum : Sum{};
  const Sum all = joined(older, older_, newer_, samples_.size() - older_);
  const auto n = static_cast<double>(samples_.size());
  if (of_ == Of::kDeviation) {
    const double variance = all.second / n;
    return std::isfinite(variance) ? std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
  }
  const double mean = all.first / n;
  // What the division left over counts, too: so the mean of equal values is their value.
  return std::isfinite(mean) ? mean + (std::fma(-mean, n, all.first) + all.second) / n : mean;
}

SlidingMoments::Sum SlidingMoments::joined(const Sum& a, std::size_t of_a, const Sum& b,
                                           std::size_t of_b) const {
  if (of_a == 0) return b;
  if (of_b == 0) return a;
  if (of_ == Of::kMean) {
    const double sum = a.first + b.first;
    if (!std::isfinite(sum)) return {sum, 0};
    const double of_b_in_sum = sum - a.first;
    const double error = (a.first - (sum - of_b_in_sum)) + (b.first - of_b_in_sum);
    const double rest = error + a.second + b.second;
    const double first = sum + rest;
    return {first, rest - (first - sum)};
  }
  const auto n_a = static_cast<double>(of_a);
  const auto n_b = static_cast<double>(of_b);
  const double share = n_b / (n_a + n_b);
  const double apart = b.first - a.first;
  return {a.first + apart * share, a.second + b.second + apart * apart * (n_a * share)};
}

void SlidingMoments::turn_over() {
  Sum sum;
  for (std::size_t i = samples_.size(); i-- > 0;) {
    sum = joined(samples_[i].sum, 1, sum, samples_.size() - 1 - i);
    samples_[i].sum = sum;
  }
  older_ = samples_.size();
  newer_ = {};
}

}  // namespace culprit::monitor
