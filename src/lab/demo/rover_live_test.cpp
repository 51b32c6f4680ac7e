// Culprit heals the live rover: a fault, the right component held responsible, no other restarted, and the mission goes on.
// The map view finds it on its map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/rover_demo.h"
#include "live/robot_names.h"

namespace culprit::lab {
namespace {

// As a map view asks for it.
link::MapPicture whole_map_within(Duration patience) {
  live::RobotNames names;
  const auto end = std::chrono::steady_clock::now() + patience;
  while (true) {
    const auto map = names.map("", 0);
    if (!map) return {};
    const bool is_whole = map->grid && !map->robots.empty() && map->path && map->scan;
    if (is_whole || std::chrono::steady_clock::now() > end) return *map;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

TEST(Rover, GoesOnDrivingAfterItsLidarStalled) {
  const std::atomic<bool> stop = false;
  auto demo = RoverDemo::start({}, stop);
  ASSERT_TRUE(demo) << demo.error();
  const double driven = (*demo)->measure().driven_m;
  const auto outcome = (*demo)->play(*rover::find_play("lidar:stall"));
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_TRUE(outcome->is_resolved()) << outcome->complaint;
  EXPECT_THAT(outcome->blamed, testing::Contains("lidar"));
  EXPECT_THAT(outcome->redeployed, testing::ElementsAre("lidar"));
  EXPECT_EQ(outcome->collisions, 0);
  EXPECT_GT((*demo)->measure().driven_m, driven);

  const link::MapPicture map = whole_map_within(std::chrono::seconds(60));
  ASSERT_TRUE(map.grid);
  EXPECT_EQ(map.topic, "/map");
  ASSERT_EQ(map.robots.size(), 1u) << testing::PrintToString(map.troubles);
  EXPECT_LT(map.robots[0].at.x, 12);
  EXPECT_TRUE(map.path);
  EXPECT_TRUE(map.scan) << testing::PrintToString(map.troubles);
}

TEST(Rover, SaysWhichFaultsThereAre) {
  EXPECT_GE(rover::faults().size(), 40U);
  const auto play = rover::find_play("lidar:melts");
  ASSERT_FALSE(play);
  EXPECT_THAT(play.error(), testing::HasSubstr("lidar:stall"));
}

}  // namespace
}  // namespace culprit::lab
