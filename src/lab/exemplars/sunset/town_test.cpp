#include "exemplars/sunset/town.h"

#include <array>

#include <gtest/gtest.h>

namespace culprit::sunset {
namespace {

TEST(Town, IsAFunctionOfItsSeed) {
  const Town town = build_town(1);
  const Town same = build_town(1);
  const Town other = build_town(2);
  int differing = 0;
  for (int y = 0; y < kTerrainCells; ++y) {
    for (int x = 0; x < kTerrainCells; ++x) {
      ASSERT_EQ(town.terrain.at(x, y).colour, same.terrain.at(x, y).colour);
      ASSERT_EQ(town.terrain.at(x, y).height, same.terrain.at(x, y).height);
      differing += town.terrain.at(x, y).label != other.terrain.at(x, y).label ? 1 : 0;
    }
  }
  EXPECT_GT(differing, kTerrainCells * kTerrainCells / 4);
}

TEST(Town, HasEveryKindOfSurface) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Town town = build_town(seed);
    std::array<int, kLabelCount> count{};
    for (int y = 0; y < kTerrainCells; ++y) {
      for (int x = 0; x < kTerrainCells; ++x) ++count[index_of(town.terrain.at(x, y).label)];
    }
    for (std::size_t label = 0; label < kLabelCount; ++label) {
      const double share = static_cast<double>(count[label]) / (kTerrainCells * kTerrainCells);
      if (label == index_of(Label::kVehicle)) {
        EXPECT_EQ(share, 0) << "vehicles stand on the terrain, they are not part of it";
      } else {
        EXPECT_GT(share, 0.005) << "label " << label << " of town " << seed;
      }
    }
    EXPECT_FALSE(town.parked.empty());
  }
}

// The march along a ray begins there.
TEST(Town, StandsBelowFifteenMetres) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Town town = build_town(seed);
    for (int y = 0; y < kTerrainCells; ++y) {
      for (int x = 0; x < kTerrainCells; ++x) {
        ASSERT_LT(height_metres(town.terrain.at(x, y).height), 15.0);
      }
    }
  }
}

TEST(Terrain, RepeatsInAllDirections) {
  Terrain terrain;
  terrain.at(1, 2).label = Label::kWater;
  EXPECT_EQ(terrain.at(1 - kTerrainCells, 2 + kTerrainCells).label, Label::kWater);
}

}  // namespace
}  // namespace culprit::sunset
