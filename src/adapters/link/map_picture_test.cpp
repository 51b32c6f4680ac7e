#include "link/map_picture.h"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using testing::HasSubstr;

ros2::msg::OccupancyGrid grid(std::uint32_t width, std::uint32_t height,
                              std::vector<std::int8_t> cells) {
  ros2::msg::OccupancyGrid grid;
  grid.info.resolution = 0.5F;
  grid.info.width = width;
  grid.info.height = height;
  grid.data = std::move(cells);
  return grid;
}

TEST(MapPicture, DrawsFreeOccupiedAndUnknownCells) {
  const auto picture = picture_of(grid(2, 3, {0, 100, -1, 50, -128, 127}));
  ASSERT_TRUE(picture) << picture.error();
  EXPECT_EQ(picture->cells, "09?4?9");
  EXPECT_EQ(picture->width, 2u);
  EXPECT_EQ(picture->height, 3u);
  EXPECT_DOUBLE_EQ(picture->resolution, 0.5);
}

// A wall of one cell must not vanish, and its place stays the same in metres.
TEST(MapPicture, DrawsALargeMapCoarserAndKeepsItsWalls) {
  constexpr std::uint32_t kWide = 3 * GridPicture::kMostCells - 1;
  auto large = grid(kWide, 2, std::vector<std::int8_t>(2UL * kWide, 0));
  large.data[kWide + 300] = 100;
  large.data[kWide - 1] = large.data[kWide - 2] = -1;
  large.data[2 * kWide - 1] = large.data[2 * kWide - 2] = -1;
  const auto picture = picture_of(large);
  ASSERT_TRUE(picture) << picture.error();
  EXPECT_EQ(picture->coarser, 3u);
  EXPECT_EQ(picture->width, GridPicture::kMostCells);
  EXPECT_EQ(picture->height, 1u);
  EXPECT_DOUBLE_EQ(picture->resolution, 1.5);
  EXPECT_EQ(picture->cells.find('9'), 100u);
  EXPECT_EQ(picture->cells.find('?'), GridPicture::kMostCells - 1);
}

TEST(MapPicture, RefusesAMessageThatContradictsItself) {
  const auto refusal = [](const ros2::msg::OccupancyGrid& bad) {
    const auto picture = picture_of(bad);
    return picture ? "it is drawn" : picture.error();
  };
  EXPECT_EQ(refusal(grid(4, 4, {0})), "it claims 4 × 4 cells, and has 1");
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  EXPECT_THAT(refusal(grid(most, most, {0})), HasSubstr("claims 4294967295 × 4294967295"));
  EXPECT_EQ(refusal(grid(0, 0, {})), "it has no cells");
  auto bad = grid(1, 1, {0});
  bad.info.resolution = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal(bad), "its cells have no size");
  bad.info.resolution = 1;
  bad.info.origin.orientation = {0, 0, 0, 0};
  EXPECT_EQ(refusal(bad), "its origin is no place");
}

TEST(MapPicture, ThinsALongPathButKeepsItsGoal) {
  ros2::msg::Path path;
  for (int i = 0; i < 10'000; ++i) path.poses.push_back({{}, {{1.0 * i, 0, 0}, {}}});
  const auto points = points_of(path, {{0, 5, 0}, {}});
  EXPECT_LE(points.size(), kMostPoints + 1);
  EXPECT_DOUBLE_EQ(points.front().x, 0);
  EXPECT_DOUBLE_EQ(points.back().x, 9'999);
  EXPECT_DOUBLE_EQ(points.back().y, 5) << "in the map's frame";
  EXPECT_TRUE(points_of(ros2::msg::Path{}, {}).empty());
}

TEST(MapPicture, DrawsTheBeamsThatHit) {
  ros2::msg::LaserScan scan;
  scan.angle_min = 0;
  scan.angle_increment = static_cast<float>(std::numbers::pi / 2);
  scan.range_min = 0.1F;
  scan.range_max = 10;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  scan.ranges = {nan, 2, 0, infinity, 10};
  const auto points = points_of(scan, {{1, 1, 0}, {}});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].x, 1, 1e-6);
  EXPECT_NEAR(points[0].y, 3, 1e-6);
}

}  // namespace
}  // namespace culprit::link
