#include "exemplars/sunset/model/entropy.h"

#include <algorithm>
#include <cmath>

namespace culprit::sunset::model {
namespace {

// Fitted to the entropies in the exemplar's logs.
constexpr EntropyLevel kHealthy{0.0185, 0.032, 0.056, 0.0072};
constexpr EntropyLevel kDegraded{0.098, 0.106, 0.116, 0.0036};
// Measured at 40 and 70 columns: 0.042 and 0.046, that is about this much more per column.
constexpr double kPerColumn = 0.0002;
// Open in the sources: the scenarios' 300 columns, of which there is no sample. The line above goes
// on to 0.092, which is a fault as it has to be.
constexpr double kShiftedDeviation = 0.0074;
// Open in the sources: a healthy picture that is enhanced wraps around into noise, and is no better
// than a degraded one.
constexpr EntropyLevel kWashedOut = kDegraded;
// Open in the sources: whether depth_degradation shows at all. It changes a thousandth of the range
// of a depth picture, and our live classifier is not unsure of it either.
constexpr double kPerNoise = 0;

}  // namespace

EntropyLevel entropy_level(const Frame& frame) {
  constexpr double kLittle = 0.1;
  EntropyLevel level = std::abs(frame.brightness - 1) < kLittle ? kHealthy
                       : frame.brightness > 1                   ? kWashedOut
                                                                : kDegraded;
  const double more = kPerColumn * frame.shift + kPerNoise * frame.noise;
  if (frame.shift > 0) level.deviation = std::max(level.deviation, kShiftedDeviation);
  level.least += more;
  level.mean += more;
  level.most += more;
  return level;
}

double Entropy::of(const Frame& frame) {
  const EntropyLevel level = entropy_level(frame);
  const double value =
      level.mean + level.deviation * scene(static_cast<std::size_t>(frame.stamp / kFramePeriod));
  return std::clamp(value, level.least, level.most);
}

double Entropy::scene(std::size_t number) {
  static const double kKept = std::exp(-seconds(kFramePeriod) / seconds(kCorrelation));
  static const double kNew = std::sqrt(1 - kKept * kKept);
  while (scenes_.size() <= number) {
    const double last = scenes_.empty() ? random_.normal() : scenes_.back();
    scenes_.push_back(kKept * last + kNew * random_.normal());
  }
  return scenes_[number];
}

}  // namespace culprit::sunset::model
