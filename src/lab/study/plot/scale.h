// From values to places on a drawing.
#pragma once

#include <string>
#include <vector>

namespace culprit::study {

// A linear axis: `low`..`high` (low < high) lies at `begin`..`end` pixels.
struct Scale {
  double low = 0;
  double high = 1;
  double begin = 0;
  double end = 1;

  double operator()(double value) const {
    return begin + (value - low) / (high - low) * (end - begin);
  }
};

// About `wanted` round values within low..high: multiples of 1, 2 or 5 times a power of ten.
std::vector<double> ticks(double low, double high, int wanted);

// As few digits as distinguish neighbouring ticks.
std::string tick_label(double tick);

}  // namespace culprit::study
