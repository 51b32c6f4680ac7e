#include "live_checks/live_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "live_checks/live_checks.h"

namespace culprit::live_checks {
namespace {

using testing::ElementsAre;

const Source kRules("robot.rules", R"(
COMPONENT lidar NODE /lidar
COMPONENT slam NODE /slam
SIGNAL entropy DIAGNOSTIC slam KEY entropy
RULE Silent
  POLICIES ERROR
  TRIGGER age(/scan) > 1s || rate(/map) < 1 || entropy > 0.5
    STRATEGY again 90 10
      ADAPTATION lidar restart 5
)");

RuleSet rules() { return *check(kRules).rules; }

LiveInventory whole_robot() {
  LiveInventory robot;
  robot.nodes["/lidar"].lifecycle = "active";
  robot.nodes["/slam"];
  robot.services["/lidar/change_state"] = "lifecycle_msgs/srv/ChangeState";
  robot.topics["/scan"] = {"sensor_msgs/msg/LaserScan", {"/lidar"}, 10.0, {}, {}};
  robot.topics["/map"] = {"nav_msgs/msg/OccupancyGrid", {"/slam"}, 2.5, {}, {}};
  robot.diagnostics = {{"slam", "", 0, {{"entropy", "0.25"}}}};
  return robot;
}

TEST(LiveFindings, SayWhatIsThereInTheOrderOfTheRules) {
  EXPECT_THAT(
      findings(rules(), whole_robot()),
      ElementsAre("lidar is /lidar, active ✓", "slam is /slam ✓", "/scan 10 Hz from /lidar ✓",
                  "/map 2.5 Hz from /slam ✓", "entropy = 0.25 ✓"));
  EXPECT_TRUE(is_all_found(rules(), whole_robot()));
}

TEST(LiveFindings, WhatIsThereAndSilentHasNoTick) {
  LiveInventory robot = whole_robot();
  robot.topics["/scan"].rate = 0;
  robot.topics["/map"].rate.reset();
  robot.diagnostics.clear();
  EXPECT_THAT(findings(rules(), robot),
              ElementsAre("lidar is /lidar, active ✓", "slam is /slam ✓",
                          "/scan from /lidar, silent", "/map from /slam ✓"));
  EXPECT_FALSE(is_all_found(rules(), robot));
}

TEST(LiveFindings, WhatIsNotThereIsLeftToTheChecks) {
  LiveInventory robot = whole_robot();
  robot.nodes.erase("/slam");
  robot.topics["/scam"] = robot.topics.extract("/scan").mapped();
  EXPECT_THAT(
      findings(rules(), robot),
      ElementsAre("lidar is /lidar, active ✓", "/map 2.5 Hz from /slam ✓", "entropy = 0.25 ✓"));
  const auto missing = missing_on(robot, kRules);
  ASSERT_EQ(missing.size(), 2u);
  EXPECT_EQ(missing[0].code, Code::kNoSuchNode);
  EXPECT_EQ(missing[1].code, Code::kNoSuchTopic);
  EXPECT_THAT(missing[1].remedy, testing::HasSubstr("/scam"));
}

TEST(LiveFindings, ToolsAndCulpritAreNoRobot) {
  LiveInventory robot;
  EXPECT_FALSE(robot.has_robot());
  robot.nodes["/culprit"];
  robot.nodes["/culprit_2"];
  robot.nodes["/_ros2cli_1234"];
  EXPECT_FALSE(robot.has_robot());
  robot.nodes["/lidar"];
  EXPECT_TRUE(robot.has_robot());
}

}  // namespace
}  // namespace culprit::live_checks
