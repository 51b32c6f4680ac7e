// Count, mean and spread of numbers that pass by once, in constant memory.
//
// Welford's recurrence, and its pairwise form for two parts of one sample (Chan, Golub, LeVeque:
// "Algorithms for Computing the Sample Variance", The American Statistician 37, 1983):
//
//     n <- n + 1,  d = x - mean,  mean <- mean + d / n,  M2 <- M2 + d (x - mean)
//
// M2 is the sum of squared deviations from the mean. There is no cancellation, however far the mean
// is from 0.
#pragma once

#include <cstdint>

namespace culprit::study {

class Moments {
 public:
  Moments() = default;
  // Moments from published figures: the mean, and the standard deviation with n - 1.
  static Moments of_summary(double mean, double sample_sd, std::int64_t count);

  void add(double value);
  void merge(const Moments& other);

  std::int64_t count() const { return count_; }
  double mean() const { return mean_; }  // 0 of nothing
  double squared_deviations() const { return squared_deviations_; }

  // With n, as numpy's std() does by default and the exemplar's tables do. 0 of nothing.
  double population_sd() const;
  // With n - 1, as tests need it. 0 of fewer than two values.
  double sample_variance() const;
  double sample_sd() const;

 private:
  std::int64_t count_ = 0;
  double mean_ = 0;
  double squared_deviations_ = 0;
};

}  // namespace culprit::study
