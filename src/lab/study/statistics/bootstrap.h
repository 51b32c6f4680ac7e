// Confidence intervals of means by bootstrap, in memory that does not grow with the number of runs.
//
// The classical bootstrap draws n of n values again and needs them all at hand. Each value is then
// drawn Binomial(n, 1/n) times, which is Poisson(1) in the limit, independently of the others: so
// each replicate is a running sum in which every value counts Poisson(1) times as it passes by.
// Source: N. Chamandy, O. Muralidharan, A. Najmi, S. Naidu: "Estimating Uncertainty for Massive
// Data Streams", Google, 2012.
//
// Whole runs are drawn, with all of their values: the reaction times of one run are not
// independent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace culprit::study {

// Few enough to be cheap; the ends of a 95 % interval are then the 25th and the 976th of them.
inline constexpr std::size_t kReplicates = 1000;

// How often a run counts in each replicate.
using Weights = std::array<std::uint8_t, kReplicates>;

// Depends on its arguments only, and is the same on every platform.
Weights poisson_weights(std::uint64_t seed, std::uint32_t row, std::uint32_t run);

struct Interval {
  double low = 0;
  double high = 0;
};

class BootstrapMean {
 public:
  // A run yielded `count` values with this sum.
  void add(const Weights& weights, double sum, double count);

  // The 95 % percentile interval. Empty if no replicate has a value, because there are too few.
  std::optional<Interval> interval() const;

 private:
  std::vector<double> sums_ = std::vector<double>(kReplicates);
  std::vector<double> counts_ = std::vector<double>(kReplicates);
};

}  // namespace culprit::study
