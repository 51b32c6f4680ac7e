#include "init/measures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/invariant.h"
#include "base/units.h"

namespace culprit::init {

double rounded_up(double number) {
  CULPRIT_ASSERT(number > 0);
  const double power = std::pow(10, std::floor(std::log10(number)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (step * power >= number) return step * power;
  }
  return 10 * power;
}

Duration rounded_up(Duration time) { return from_seconds(rounded_up(seconds(time))); }

std::string as_number(double number) {
  const std::string text = fmt::format("{:.3g}", number);
  return text == "-0" ? "0" : text;
}

double share_above(std::size_t measurements) {
  return std::min(1.0, 3 / static_cast<double>(measurements));
}

double share_outside(std::size_t measurements) {
  return std::min(1.0, 4.74 / static_cast<double>(measurements));
}

}  // namespace culprit::init
