// Culprit heals the live rover: a fault, the right component held responsible, no other restarted, and the mission goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/rover_demo.h"

namespace culprit::lab {
namespace {

TEST(Rover, GoesOnDrivingAfterItsLidarStalled) {
  const std::atomic<bool> stop = false;
  auto demo = RoverDemo::start({}, stop);
  ASSERT_TRUE(demo) << demo.error();
  const double driven = (*demo)->measure().driven_m;
  const auto outcome = (*demo)->play(*RoverDemo::find_play("lidar:stall"));
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_TRUE(outcome->is_resolved()) << outcome->complaint;
  EXPECT_THAT(outcome->blamed, testing::Contains("lidar"));
  EXPECT_THAT(outcome->redeployed, testing::ElementsAre("lidar"));
  EXPECT_EQ(outcome->collisions, 0);
  EXPECT_GT((*demo)->measure().driven_m, driven);
}

TEST(Rover, SaysWhichFaultsThereAre) {
  EXPECT_GE(rover::faults().size(), 40U);
  const auto play = RoverDemo::find_play("lidar:melts");
  ASSERT_FALSE(play);
  EXPECT_THAT(play.error(), testing::HasSubstr("lidar:stall"));
}

}  // namespace
}  // namespace culprit::lab
