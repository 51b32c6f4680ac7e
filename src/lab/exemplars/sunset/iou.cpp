#include "exemplars/sunset/iou.h"

#include <limits>
#include <stdexcept>

namespace culprit::sunset {

Iou iou(const LabelImage& predicted, const LabelImage& truth) {
  if (predicted.size != truth.size) {
    throw std::invalid_argument("iou: the two label images differ in size");
  }
  // One more counter than labels: a byte off the wire may hold anything.
  using Counters = std::array<int, kLabelCount + 1>;
  Counters in_both{};
  Counters in_predicted{};
  Counters in_truth{};
  const auto counter = [](Label label) {
    return index_of(label) < kLabelCount ? index_of(label) : std::size_t{kLabelCount};
  };
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const std::size_t guess = counter(predicted.pixels[i]);
    const std::size_t fact = counter(truth.pixels[i]);
    ++in_predicted[guess];
    ++in_truth[fact];
    if (guess == fact) ++in_both[fact];
  }

  Iou result;
  double sum = 0;
  int occurring = 0;
  for (std::size_t label = 0; label < kLabelCount; ++label) {
    const int in_either = in_predicted[label] + in_truth[label] - in_both[label];
    result.per_class[label] = static_cast<double>(in_both[label]) / in_either;
    if (in_either == 0) continue;
    sum += result.per_class[label];
    ++occurring;
  }
  result.mean = occurring == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / occurring;
  return result;
}

}  // namespace culprit::sunset
