#include "exemplars/suave/model/visibility.h"

#include <cmath>
#include <numbers>

namespace culprit::suave::model {

double water_visibility(std::int64_t second) {
  constexpr std::int64_t kPeriod = 80;
  constexpr double kLeast = 1.25;
  constexpr double kMost = 3.75;
  constexpr double kAmplitude = (kMost - kLeast) / 2;
  const double angle =
      2 * std::numbers::pi * static_cast<double>(second % kPeriod) / static_cast<double>(kPeriod);
  // Cut after a nanometre, so that no C library's last bit decides on which side of a threshold the
  // least value is.
  return std::round((kAmplitude * std::cos(angle) + kAmplitude + kLeast) * 1e9) / 1e9;
}

}  // namespace culprit::suave::model
