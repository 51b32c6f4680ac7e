#include "exemplars/suave/model/spiral.h"

#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::suave::model {
namespace {

constexpr Position kCentre = {-17, 2.35, -18.5};

Spiral begun() {
  Spiral spiral;
  spiral.restart(kCentre);
  return spiral;
}

double radius(const Position& p) { return std::hypot(p.x - kCentre.x, p.y - kCentre.y); }

RC_GTEST_PROP(Spiral, GrowsByARingPerTurnWhereTheVehicleKeepsUp, ()) {
  const double altitude = *rc::gen::element(1.0, 2.0, 3.0);
  const int steps = *rc::gen::inRange(1, 200);
  Spiral spiral = begun();
  Position vehicle = kCentre;
  for (int step = 0; step < steps; ++step) {
    const auto goal = spiral.tick(vehicle, altitude);
    RC_ASSERT(goal.has_value());
    vehicle = *goal;
  }
  // As the exemplar: after k steps k w / 62.8, w = 1.1547 altitude
  RC_ASSERT(std::abs(radius(vehicle) - steps * 1.1547 * altitude / (20 * std::numbers::pi)) < 0.01);
  RC_ASSERT(std::abs(vehicle.z - (kSeabed + altitude)) < 1e-9);
}

TEST(Spiral, SkipsAnAngleWhenTheAltitudeChanges) {
  Spiral steady = begun();
  Spiral changed = begun();
  const Position first = *steady.tick(kCentre, 2);
  ASSERT_EQ(changed.tick(kCentre, 2)->x, first.x);
  const Position second = *steady.tick(first, 2);
  const Position other = *changed.tick(first, 3);
  const auto angle = [](const Position& p) { return std::atan2(p.y - kCentre.y, p.x - kCentre.x); };
  EXPECT_NEAR(angle(other) - angle(second), 0.1, 1e-6);
}

TEST(Spiral, WaitsForTheVehicleAndRepeatsItselfAfterTenTicks) {
  Spiral spiral = begun();
  const Position goal = *spiral.tick(kCentre, 3);
  const Position astray{goal.x + 5, goal.y, goal.z};
  for (int tick = 0; tick < 10; ++tick) EXPECT_FALSE(spiral.tick(astray, 3));
  const auto repeated = spiral.tick(astray, 3);
  ASSERT_TRUE(repeated);
  EXPECT_EQ(repeated->x, goal.x);
  EXPECT_EQ(repeated->z, goal.z);
}

TEST(Spiral, AimsLowerWhereTheVehicleDoesNotGetUp) {
  Spiral spiral = begun();
  const Position goal = *spiral.tick(kCentre, 3);
  const Position below{goal.x, goal.y, goal.z - 1};
  std::optional<Position> repeated;
  for (int tick = 0; tick <= 10; ++tick) repeated = spiral.tick(below, 3);
  ASSERT_TRUE(repeated);
  EXPECT_DOUBLE_EQ(repeated->z, goal.z - 0.25);
}

}  // namespace
}  // namespace culprit::suave::model
