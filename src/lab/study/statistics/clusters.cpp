#include "study/statistics/clusters.h"

#include <algorithm>
#include <cmath>

namespace culprit::study {

void Clusters::add(double sum, double count) {
  ++clusters_;
  squared_sums_ += sum * sum;
  products_ += sum * count;
  squared_counts_ += count * count;
}

Moments Clusters::independent(const Moments& all) const {
  if (clusters_ == all.count()) return all;
  if (clusters_ < 2)
    return Moments::of_summary(all.mean(), 0, std::min<std::int64_t>(1, clusters_));
  const auto clusters = static_cast<double>(clusters_);
  const auto count = static_cast<double>(all.count());
  const double m = all.mean();
  const double squares = squared_sums_ - 2 * m * products_ + m * m * squared_counts_;
  const double squared_error = clusters / (clusters - 1) * std::max(0.0, squares) / (count * count);
  double worth = count;
  if (squared_error > 0) worth = std::min(count, all.sample_variance() / squared_error);
  return Moments::of_summary(m, all.sample_sd(), std::max<std::int64_t>(2, std::llround(worth)));
}

}  // namespace culprit::study
