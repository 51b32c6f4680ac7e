#include "monitor/sliding_values.h"

#include <algorithm>
#include <cmath>

namespace culprit::monitor {

void SlidingValues::add(Time at, double value) {
  advance(at);
  if (samples_.full()) samples_.pop_front();
  samples_.push_back({at, value});
}

void SlidingValues::advance(Time now) {
  while (!samples_.empty() && later(samples_.front().at, window_) <= now) samples_.pop_front();
}

Time SlidingValues::next_change() const {
  return samples_.empty() ? kNever : later(samples_[0].at, window_);
}

std::optional<SlidingValues::Summary> SlidingValues::summary() const {
  if (samples_.empty()) return std::nullopt;
  Summary s{0, samples_[0].value, samples_[0].value, 0};
  const auto count = static_cast<double>(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    s.mean += samples_[i].value;
    s.min = std::min(s.min, samples_[i].value);
    s.max = std::max(s.max, samples_[i].value);
  }
  s.mean /= count;
  double squares = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    squares += (samples_[i].value - s.mean) * (samples_[i].value - s.mean);
  }
  s.stddev = std::sqrt(squares / count);
  return s;
}

}  // namespace culprit::monitor
