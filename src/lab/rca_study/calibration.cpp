#include "rca_study/calibration.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"

namespace culprit::study::rca {

void Calibration::add(double forecast, bool came_true) {
  const auto place = static_cast<std::size_t>(forecast * static_cast<double>(bins_.size()));
  add(std::min(place, bins_.size() - 1), forecast, came_true);
}

void Calibration::add(std::size_t bin, double forecast, bool came_true) {
  CULPRIT_ASSERT(bin < bins_.size());
  bins_[bin].forecast.add(forecast);
  bins_[bin].outcome.add(came_true ? 1 : 0);
}

std::int64_t Calibration::count() const {
  std::int64_t sum = 0;
  for (const Bin& bin : bins_) sum += bin.forecast.count();
  return sum;
}

double Calibration::error() const {
  double sum = 0;
  for (const Bin& bin : bins_)
    sum += static_cast<double>(bin.forecast.count()) *
           std::abs(bin.forecast.mean() - bin.outcome.mean());
  return count() == 0 ? 0 : sum / static_cast<double>(count());
}

}  // namespace culprit::study::rca
