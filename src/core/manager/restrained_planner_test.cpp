// The governor is asked about exactly the strategies that would begin.
#include "manager/restrained_planner.h"

#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/passive_planner.h"

namespace culprit {
namespace {

using test::TestRobot;
using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lidar NODE /lidar LAUNCH "lidar"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 60 10
      ADAPTATION camera restart 3
    STRATEGY wrong_one 99 10
      ADAPTATION lidar redeploy 1
RULE LidarSilent
  POLICIES ERROR
  TRIGGER age(/scan) > 300ms
    STRATEGY again 90 10
      ADAPTATION lidar redeploy 5
)";

// The strategy that is chosen for a silent camera.
std::string choice(bool has_namesake) {
  TestRobot robot(kRules, std::make_unique<PassivePlanner>());
  robot.add("camera", {}, "/rgb");
  robot.add("lidar", {}, "/scan");
  robot.discover();
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
  robot.tell(EndpointAppeared{"/lidar", EndpointKind::kPublisher, "/scan"}, 6s);
  robot.fail("camera", "restart", 1s);
  if (has_namesake) robot.tell(NamesakesSeen{"/camera", 1});
  const BayesPlanner planner;
  const auto decisions =
      RestrainedPlanner(planner).plan(robot.manager().plannable(), robot.manager().knowledge());
  EXPECT_EQ(decisions.size(), 1u);
  for (const auto& each : robot.manager().knowledge().withheld) EXPECT_EQ(each.reason, "");
  if (decisions.empty() || !decisions.front().chosen) return "";
  return robot.rules()[*decisions.front().chosen].name;
}

TEST(RestrainedPlanner, ChoosesNoRedeployThatTheEvidenceSpeaksAgainst) {
  EXPECT_EQ(choice(false), "restart") << "the lidar runs and is heard";
}

// The permission for one strategy is not valid for another one.
TEST(RestrainedPlanner, AsksOfEachThatIsChosen) {
  TestRobot robot(kRules, std::make_unique<PassivePlanner>());
  robot.add("camera", {}, "/rgb");
  robot.add("lidar", {}, "/scan");
  robot.discover(6s);
  robot["camera"].fault = "restart";
  robot.fail("lidar", "redeploy", 1s);
  robot.tell(NamesakesSeen{"/camera", 1});
  const BayesPlanner planner;
  const auto decisions =
      RestrainedPlanner(planner).plan(robot.manager().plannable(), robot.manager().knowledge());
  std::vector<std::string> chosen;
  for (const Decision& decision : decisions) {
    if (decision.chosen) chosen.push_back(robot.rules()[*decision.chosen].name);
  }
  ASSERT_EQ(chosen.size(), 1u) << "the lidar is repaired";
  EXPECT_NE(chosen.front(), "restart") << "the camera has a namesake";
}

TEST(RestrainedPlanner, ChoosesNothingWhereTheAffectedComponentsAreUnknown) {
  EXPECT_EQ(choice(true), "");
}

}  // namespace
}  // namespace culprit
