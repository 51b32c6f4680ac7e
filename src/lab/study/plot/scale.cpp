#include "study/plot/scale.h"

#include <cmath>

#include <fmt/core.h>

namespace culprit::study {
namespace {

double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

}  // namespace

std::vector<double> ticks(double low, double high, int wanted) {
  const double step = round_step((high - low) / wanted);
  std::vector<double> ticks;
  const double tolerance = 1e-9;  // of a step
  for (double i = std::ceil(low / step - tolerance); i <= high / step + tolerance; ++i)
    ticks.push_back(i * step);
  return ticks;
}

std::string tick_label(double tick) { return fmt::format("{:.6g}", tick + 0.0); }

}  // namespace culprit::study
