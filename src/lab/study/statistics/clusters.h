// How much a mean of values is worth that come in clusters, such as the reaction times of one run,
// which are not independent.
//
// The values x of cluster r have the sum s_r and the count c_r; all N of them the mean m. The squared
// standard error of m, by linearization over R clusters (Cochran: "Sampling Techniques", 1977, on
// ratio estimators):
//
//     e^2 = R / (R - 1)  sum_r (s_r - m c_r)^2 / N^2
//
// As many independent values with the sample variance v would have the same error: v / e^2. With one
// value a cluster these are N.
#pragma once

#include <cstdint>

#include "study/statistics/moments.h"

namespace culprit::study {

class Clusters {
 public:
  // A cluster with `count` > 0 values.
  void add(double sum, double count);

  // `all`, the moments of the values, as of so many independent ones: at most as many as there are,
  // at least as many as a test needs (two, if there are two clusters).
  Moments independent(const Moments& all) const;

 private:
  std::int64_t clusters_ = 0;
  double squared_sums_ = 0;
  double products_ = 0;  // of sum and count
  double squared_counts_ = 0;
};

}  // namespace culprit::study
