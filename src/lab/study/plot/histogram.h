// Counts values of a distribution in equal bins.
#pragma once

#include <cstdint>
#include <vector>

#include "study/statistics/distribution.h"

namespace culprit::study {

struct Bins {
  double low = 0;
  double width = 1;
  int count = 1;

  double high() const { return low + width * count; }
};

struct Histogram {
  std::vector<std::int64_t> counts;  // one for each bin
  std::int64_t beyond = 0;           // above the last bin

  std::int64_t highest() const;
};

// A value below the first bin is counted in it. A value at an edge belongs to the bin above.
Histogram histogram(const Distribution& distribution, const Bins& bins);

}  // namespace culprit::study
