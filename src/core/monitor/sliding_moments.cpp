#include "monitor/sliding_moments.h"

#include <cmath>
#include <limits>

namespace culprit::monitor {

bool SlidingMoments::add(Time at, double value) {
  if (samples_.full()) return false;
  samples_.push_back({at, value});
  newest_ = joined(newest_, in_newest_, {value, 0}, 1);
  if (++in_newest_ == kBlock) end_block();
  return true;
}

void SlidingMoments::forget_until(Time time) {
  while (!samples_.empty() && samples_.front().at <= time) {
    if (oldest_.empty()) begin_oldest();
    oldest_.pop_back();
    samples_.pop_front();
  }
}

void SlidingMoments::clear() {
  samples_.clear();
  oldest_.clear();
  blocks_.clear();
  older_ = in_newest_ = 0;
  newer_ = newest_ = {};
}

// The newest block is full.
void SlidingMoments::end_block() {
  newer_ = joined(newer_, (blocks_.size() - older_) * kBlock, newest_, kBlock);
  blocks_.push_back(newest_);
  newest_ = {};
  in_newest_ = 0;
}

// The first block becomes the oldest one. If there is none, the newest one does, though it is not full.
void SlidingMoments::begin_oldest() {
  std::size_t count = kBlock;
  if (blocks_.empty()) {
    count = in_newest_;
    newest_ = {};
    in_newest_ = 0;
  } else {
    pop_block();
  }
  Sum sum;
  for (std::size_t i = count; i-- > 0;) {
    sum = joined({samples_[i].value, 0}, 1, sum, count - 1 - i);
    oldest_.push_back(sum);
  }
}

void SlidingMoments::pop_block() {
  if (older_ == 0) {
    Sum sum;
    for (std::size_t i = blocks_.size(); i-- > 0;) {
      sum = joined(blocks_[i], kBlock, sum, (blocks_.size() - 1 - i) * kBlock);
      blocks_[i] = sum;
    }
    older_ = blocks_.size();
    newer_ = {};
  }
  blocks_.pop_front();
  --older_;
}

double SlidingMoments::value() const {
  const Sum oldest = oldest_.empty() ? Sum{} : oldest_.back();
  const Sum older = older_ > 0 ? blocks_.front() : Sum{};
  std::size_t count = oldest_.size();
  Sum all = oldest;
  const auto put = [&](const Sum& next, std::size_t of_next) {
    all = joined(all, count, next, of_next);
    count += of_next;
  };
  put(older, older_ * kBlock);
  put(newer_, (blocks_.size() - older_) * kBlock);
  put(newest_, in_newest_);
  const auto n = static_cast<double>(samples_.size());
  if (of_ == Of::kDeviation) {
    const double variance = all.second / n;
    return std::isfinite(variance) ? std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
  }
  const double mean = all.first / n;
  // The remainder of the division counts, too: so the mean of equal values is their value.
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

}  // namespace culprit::monitor
