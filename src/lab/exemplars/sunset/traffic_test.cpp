#include "exemplars/sunset/traffic.h"

#include <cmath>

#include <gtest/gtest.h>

#include "exemplars/sunset/terrain.h"
#include "exemplars/sunset/town.h"

namespace culprit::sunset {
namespace {

TEST(Traffic, DrivesForwardsAtTownSpeed) {
  const std::vector<Road> roads = build_town(1).roads;
  const std::vector<Vehicle> before = moving_vehicles(roads, 3, 10.0);
  const std::vector<Vehicle> after = moving_vehicles(roads, 3, 10.1);
  ASSERT_EQ(before.size(), after.size());
  ASSERT_FALSE(before.empty());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double dx = after[i].centre.x - before[i].centre.x;
    const double dy = after[i].centre.y - before[i].centre.y;
    const double forwards = dx * before[i].front.x + dy * before[i].front.y;
    if (std::abs(forwards) > 0.5 * kTerrainMetres) continue;  // it crossed the torus' seam
    EXPECT_GE(forwards, 0.69);
    EXPECT_LE(forwards, 1.21);
  }
}

TEST(Traffic, KeepsToTheRightHandSideOfAsphalt) {
  Road road;
  road.centre = 100;
  road.half_width = 5;
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    road.axis = axis;
    for (const Vehicle& vehicle : moving_vehicles({road}, 3, 10.0)) {
      // With x to the right and y down, the right-hand side of (fx, fy) is (-fy, fx).
      const double across = axis == Axis::kX ? vehicle.centre.y - 100 : vehicle.centre.x - 100;
      const double right = axis == Axis::kX ? across * vehicle.front.x : -across * vehicle.front.y;
      EXPECT_GT(right - 0.5 * vehicle.width, 0);
      EXPECT_LT(right + 0.5 * vehicle.width, road.half_width);
    }
  }
}

}  // namespace
}  // namespace culprit::sunset
