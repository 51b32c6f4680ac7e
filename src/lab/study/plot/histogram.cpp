#include "study/plot/histogram.h"

#include <algorithm>
#include <cmath>

namespace culprit::study {

std::int64_t Histogram::highest() const {
  return counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
}

Histogram histogram(const Distribution& distribution, const Bins& bins) {
  Histogram histogram;
  histogram.counts.resize(static_cast<std::size_t>(bins.count));
  for (const auto& [value, count] : distribution.counts()) {
    const double bin = std::floor((value - bins.low) / bins.width);
    if (bin >= bins.count) {
      histogram.beyond += count;
    } else {
      histogram.counts[static_cast<std::size_t>(std::max(bin, 0.0))] += count;
    }
  }
  return histogram;
}

}  // namespace culprit::study
