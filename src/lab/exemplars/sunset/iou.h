// How well a segmentation agrees with the truth: intersection over union, as SUNSET's evaluator
// computes it for one frame.
#pragma once

#include <array>

#include "exemplars/sunset/image.h"

namespace culprit::sunset {

// All in [0, 1], or NaN where a class occurs in neither image.
struct Iou {
  std::array<double, kLabelCount> per_class{};
  double mean = 0;  // over the classes that occur

  double road() const { return per_class[index_of(Label::kRoad)]; }
  double vehicle() const { return per_class[index_of(Label::kVehicle)]; }
};

// Pixels that carry no known label count as wrong. Throws std::invalid_argument if the sizes
// differ.
Iou iou(const LabelImage& predicted, const LabelImage& truth);

}  // namespace culprit::sunset
