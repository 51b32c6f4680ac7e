// Do things happen as often as was said? Forecasts of one kind beside what came true.
//
//     ECE = sum_b n_b / n | mean forecast in b - share in b that came true |
//
// over ten bins b of equal width: the expected calibration error. Source: Naeini, Cooper,
// Hauskrecht, "Obtaining well calibrated probabilities using Bayesian binning", AAAI 2015.
#pragma once

#include <array>

#include "study/statistics/moments.h"

namespace culprit::study::rca {

class Calibration {
 public:
  static constexpr std::size_t kBins = 10;
  struct Bin {
    Moments forecast;
    Moments outcome;  // 0 or 1
  };

  // `forecast` is a probability.
  void add(double forecast, bool came_true);

  const std::array<Bin, kBins>& bins() const { return bins_; }
  std::int64_t count() const;
  double error() const;  // ECE; 0 of nothing

 private:
  std::array<Bin, kBins> bins_;
};

}  // namespace culprit::study::rca
