// Do things happen as often as was said? Forecasts of one kind beside what came true.
//
//     ECE = sum_b n_b / n | mean forecast in b - share in b that came true |
//
// over ten bins b of equal width: the expected calibration error. Bins may be anything else that
// forecasts have in common, as the strategy that they are about. Source: Naeini, Cooper,
// Hauskrecht, "Obtaining well calibrated probabilities using Bayesian binning", AAAI 2015.
#pragma once

#include <vector>

#include "study/statistics/moments.h"

namespace culprit::study::rca {

class Calibration {
 public:
  struct Bin {
    Moments forecast;
    Moments outcome;  // 0 or 1
  };

  explicit Calibration(std::size_t bins = 10) : bins_(bins) {}

  // `forecast` is a probability; its bin is where it lies between 0 and 1.
  void add(double forecast, bool came_true);
  // To another bin. @pre bin < bins().size()
  void add(std::size_t bin, double forecast, bool came_true);

  const std::vector<Bin>& bins() const { return bins_; }
  std::int64_t count() const;
  double error() const;  // ECE; 0 of nothing

 private:
  std::vector<Bin> bins_;
};

}  // namespace culprit::study::rca
