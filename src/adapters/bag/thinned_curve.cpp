#include "bag/thinned_curve.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"

namespace culprit::bag {

void ThinnedCurve::add(std::int64_t at, double value) {
  if (!(std::abs(value) <= kMostValue)) return;
  if (samples_ == 0) {
    first_ = last_ = at;
    lowest_ = highest_ = value;
  }
  ++samples_;
  last_ = std::max(last_, at);
  lowest_ = std::min(lowest_, value);
  highest_ = std::max(highest_, value);
  const Point point{last_, value};
  const std::int64_t place = (last_ - first_) / width_;
  if (buckets_.empty() || buckets_.back().place != place) {
    buckets_.push_back({place, point, point});
  } else {
    Bucket& bucket = buckets_.back();
    if (value < bucket.low.value) bucket.low = point;
    if (value > bucket.high.value) bucket.high = point;
  }
  while (buckets_.size() > kMostBuckets) halve();
}

void ThinnedCurve::halve() {
  width_ *= 2;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    Bucket bucket = buckets_[i];
    bucket.place /= 2;
    if (kept > 0 && buckets_[kept - 1].place == bucket.place) {
      Bucket& before = buckets_[kept - 1];
      if (bucket.low.value < before.low.value) before.low = bucket.low;
      if (bucket.high.value > before.high.value) before.high = bucket.high;
    } else {
      buckets_[kept++] = bucket;
    }
  }
  buckets_.resize(kept);
}

std::vector<ThinnedCurve::Point> ThinnedCurve::points() const {
  std::vector<Point> points;
  for (const Bucket& bucket : buckets_) {
    const bool is_low_first = bucket.low.at <= bucket.high.at;
    points.push_back(is_low_first ? bucket.low : bucket.high);
    if (bucket.low != bucket.high) points.push_back(is_low_first ? bucket.high : bucket.low);
  }
  return points;
}

std::int64_t ThinnedCurve::longest_gap() const {
  CULPRIT_ASSERT(samples_ > 0);
  constexpr std::int64_t kTimes = 5;  // the mean distance; messages of a robot come no more evenly
  if (samples_ == 1) return 0;
  const std::int64_t mean = (last_ - first_) / static_cast<std::int64_t>(samples_ - 1);
  // Lowest and highest of neighbours may lie two spans apart.
  return std::max(mean > INT64_MAX / kTimes ? mean : kTimes * mean, 2 * width_);
}

}  // namespace culprit::bag
