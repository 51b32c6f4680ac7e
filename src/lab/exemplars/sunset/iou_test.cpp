#include "exemplars/sunset/iou.h"

#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "simulation/random.h"

namespace culprit::sunset {
namespace {

LabelImage row(std::initializer_list<Label> labels) {
  LabelImage image(Size{static_cast<int>(labels.size()), 1});
  image.pixels = labels;
  return image;
}

LabelImage random_labels(std::uint64_t seed) {
  simulation::Random random(seed);
  LabelImage image(Size{16, 12});
  for (Label& label : image.pixels) label = static_cast<Label>(random.below(kLabelCount));
  return image;
}

RC_GTEST_PROP(Iou, OfAnImageWithItselfIsOne, (std::uint64_t seed)) {
  const LabelImage labels = random_labels(seed);
  RC_ASSERT(iou(labels, labels).mean == 1.0);
}

RC_GTEST_PROP(Iou, IsSymmetric, (std::uint64_t seed)) {
  const LabelImage a = random_labels(seed);
  const LabelImage b = random_labels(seed + 1);
  RC_ASSERT(iou(a, b).mean == iou(b, a).mean);
}

TEST(Iou, IsTheSharedPartOfEachClass) {
  const Iou result = iou(row({Label::kRoad, Label::kRoad, Label::kRoad, Label::kVehicle}),
                         row({Label::kRoad, Label::kVehicle, Label::kVehicle, Label::kVehicle}));
  EXPECT_DOUBLE_EQ(result.road(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(result.vehicle(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(result.mean, 1.0 / 3.0);
}

TEST(Iou, LeavesOutClassesThatOccurNowhere) {
  const Iou result = iou(row({Label::kRoad}), row({Label::kRoad}));
  EXPECT_TRUE(std::isnan(result.vehicle()));
  EXPECT_EQ(result.mean, 1.0);
}

TEST(Iou, OfNothingIsNotANumber) { EXPECT_TRUE(std::isnan(iou({}, {}).mean)); }

TEST(Iou, CountsUnknownLabelsAsWrong) {
  const Iou result =
      iou(row({Label::kRoad, static_cast<Label>(200)}), row({Label::kRoad, Label::kRoad}));
  EXPECT_DOUBLE_EQ(result.road(), 0.5);
  EXPECT_DOUBLE_EQ(result.mean, 0.5);
}

TEST(Iou, RefusesImagesOfDifferentSize) {
  EXPECT_THROW(iou(row({Label::kRoad}), row({})), std::invalid_argument);
}

}  // namespace
}  // namespace culprit::sunset
