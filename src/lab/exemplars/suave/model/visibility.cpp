#include "exemplars/suave/model/visibility.h"

#include <cmath>
#include <numbers>

namespace culprit::suave::model {

double water_visibility(std::int64_t second, double period_s, double shift_s, double least,
                        double most) {
  const double amplitude = (most - least) / 2;
  const double phase = std::fmod(static_cast<double>(second) + shift_s, period_s) / period_s;
  const double angle = 2 * std::numbers::pi * phase;
  // Cut after a nanometre, so that no C library's last bit decides on which side of a threshold the
  // least value is.
  return std::round((amplitude * std::cos(angle) + amplitude + least) * 1e9) / 1e9;
}

}  // namespace culprit::suave::model
