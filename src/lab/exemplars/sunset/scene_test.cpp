#include "exemplars/sunset/scene.h"

#include <cmath>

#include <gtest/gtest.h>

#include "exemplars/sunset/terrain.h"

namespace culprit::sunset {
namespace {

double height_of(std::uint16_t depth) { return kAltitudeMetres - depth * kDepthMetresPerCount; }

double agreement(const LabelImage& a, const LabelImage& b) {
  double same = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) same += a.pixels[i] == b.pixels[i] ? 1 : 0;
  return same / static_cast<double>(a.pixels.size());
}

TEST(Scene, IsAFunctionOfSeedAndNumber) {
  const Frame frame = Scene(4).frame(17);
  const Frame again = Scene(4).frame(17);
  EXPECT_EQ(frame.rgb, again.rgb);
  EXPECT_EQ(frame.depth, again.depth);
  EXPECT_EQ(frame.truth, again.truth);
  EXPECT_NE(frame.rgb, Scene(5).frame(17).rgb);
  EXPECT_NE(frame.rgb, Scene(4).frame(18).rgb);
}

TEST(Scene, FitsOneDatagram) {
  EXPECT_LT(Scene(1).frame(0).rgb.pixels.size() * sizeof(Rgb), 65'507U);
}

TEST(Scene, MovesSmoothly) {
  const Scene scene(6);
  for (std::uint64_t number = 0; number < 60; ++number) {
    const Pose here = scene.pose(number);
    const Pose next = scene.pose(number + 1);
    const double step =
        std::hypot(std::remainder(next.position.x - here.position.x, kTerrainMetres),
                   std::remainder(next.position.y - here.position.y, kTerrainMetres));
    EXPECT_NEAR(step, 0.6, 0.15);
    EXPECT_GT(here.up.x * next.up.x + here.up.y * next.up.y, std::cos(0.005));
  }
  for (std::uint64_t number = 0; number < 600; number += 60) {
    const LabelImage here = scene.frame(number).truth;
    EXPECT_GT(agreement(here, scene.frame(number + 1).truth), 0.85);
    EXPECT_LT(agreement(here, scene.frame(number + 300).truth), 0.85);
  }
}

TEST(Scene, ShowsHeightInItsDepth) {
  const Scene scene(9);
  for (std::uint64_t number = 0; number < 500; number += 50) {
    const Frame frame = scene.frame(number);
    for (std::size_t i = 0; i < frame.truth.pixels.size(); ++i) {
      const double height = height_of(frame.depth.pixels[i]);
      switch (frame.truth.pixels[i]) {
        case Label::kRoad:
        case Label::kPavement:
        case Label::kGrass:
        case Label::kGround:
        case Label::kWater:
          ASSERT_NEAR(height, 0.0, 0.4);
          break;
        case Label::kVehicle:
          ASSERT_NEAR(height, 1.8, 1.3);
          break;
        case Label::kTree:
        case Label::kBuilding:
          ASSERT_GT(height, 0.1);
          ASSERT_LT(height, 15.2);
          break;
      }
    }
  }
}

TEST(Scene, HasAnySize) {
  const Frame frame = Scene(1, Size{64, 48}).frame(0);
  EXPECT_EQ(frame.rgb.size, (Size{64, 48}));
  EXPECT_EQ(frame.depth.size, (Size{64, 48}));
  EXPECT_EQ(frame.truth.size, (Size{64, 48}));
}

}  // namespace
}  // namespace culprit::sunset
