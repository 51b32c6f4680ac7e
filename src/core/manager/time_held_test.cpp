// Nodes of simulated time, whose clock stands still, beside nodes of real time: nothing is judged about
// the first, and everything about the others.
#include <utility>

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kSimulatedRules = R"(
COMPONENT camera   NODE /camera   LAUNCH "camera"
COMPONENT detector NODE /detector LAUNCH "detector"
COMPONENT driver   NODE /driver   LAUNCH "driver"
RULE CameraSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER !alive(camera) || age(/rgb) > 500ms
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 10
RULE CameraSlow
  POLICIES ERROR ATTEMPTS 2
  TRIGGER rate(/rgb) < 5
    STRATEGY camera_again 90 10
      ADAPTATION camera redeploy 10
RULE DetectorSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER !alive(detector) || age(/boxes) > 500ms
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 10
RULE DriverSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER !alive(driver) || age(/odometry) > 500ms
    STRATEGY driver_redeploy 90 10
      ADAPTATION driver redeploy 10
)";

// The camera uses simulated time, its consumer and the driver do not.
struct HalfSimulated {
  HalfSimulated() : robot(kSimulatedRules) {
    robot.add("camera", {}, "/rgb");
    robot.add("detector", {"camera"}, "/boxes");
    robot.add("driver", {}, "/odometry");
    robot.discover();
    for (const auto& [node, topic] :
         {std::pair("/camera", "/rgb"), std::pair("/detector", "/boxes"),
          std::pair("/driver", "/odometry")})
      robot.tell(EndpointAppeared{node, EndpointKind::kPublisher, topic});
    robot.run_for(8s);
    EXPECT_EQ(robot.count("detected"), 0u);
    robot.said.clear();
  }
  // Stops the camera's clock, or lets it go on.
  void hold(bool is_held) {
    robot["camera"].fault = is_held ? "its clock" : "";
    robot.run_for(150ms);
    robot.tell(TimeHeld{robot.id("camera"), is_held});
  }
  TestRobot robot;
};

TEST(TimeHeld, NothingIsJudgedAboutItsNodesAndThoseThatReadFromThem) {
  HalfSimulated simulated;
  TestRobot& robot = simulated.robot;
  for (const Duration length : {Duration(700ms), Duration(20s), Duration(300s)}) {
    simulated.hold(true);
    robot.run_for(length);
    simulated.hold(false);
    robot.run_for(20s);
  }
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_EQ(robot.count("blind"), 0u);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(TimeHeld, NodesOfRealTimeAreRepairedMeanwhile) {
  HalfSimulated simulated;
  TestRobot& robot = simulated.robot;
  simulated.hold(true);
  robot.run_for(5s);
  robot.fail("driver", "redeploy", 10s);
  EXPECT_TRUE(robot.works("driver"));
  robot.kill("detector", 10s);
  EXPECT_TRUE(robot.was_asked("detector: start process"));
  EXPECT_FALSE(robot.was_asked("camera:"));
}

TEST(TimeHeld, AGoalDoesNotAgeMeanwhile) {
  TestRobot robot(
      "COMPONENT driver NODE /driver\n"
      "RULE Slow\n  POLICIES WARNING REPORT\n  TRIGGER goal_age(/go) > 10s\n");
  robot.add("driver", {}, "/go/_action/status");
  robot.discover();
  robot.tell(EndpointAppeared{"/driver", EndpointKind::kPublisher, "/go/_action/status"}, 8s);
  robot.tell(GoalsSeen{TopicId(0), {{1, GoalStatus::kExecuting}}}, 6s);
  robot.tell(TimeHeld{robot.id("driver"), true}, 60s);
  robot.tell(TimeHeld{robot.id("driver"), false}, 3s);
  EXPECT_EQ(robot.count("Slow detected"), 0u);
  robot.run_for(2s);
  EXPECT_EQ(robot.count("Slow detected"), 1u);
}

// A failure that follows a step of the system clock names it.
std::string evidence_of(const TestRobot& robot) {
  std::string text;
  for (const Event& event : robot.events) {
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    if (chosen == nullptr || chosen->suspects.empty()) continue;
    for (const Evidence& each : chosen->suspects.front().evidence) text += describe(each) + "\n";
  }
  return text;
}

TEST(ClockStep, IsNamedInTheFailureThatFollows) {
  constexpr const char* kSet = "the system clock of this computer was set back by 1 h";
  for (const Duration before : {Duration(2s), Duration(3h)}) {
    HalfSimulated robots;
    TestRobot& robot = robots.robot;
    robot.tell(ClockStepped{-1h});
    EXPECT_EQ(robot.count(kSet), 1u);
    robot.run_for(before);
    robot.fail("camera", "redeploy", 10s);
    EXPECT_TRUE(robot.works("camera"));
    const bool is_named = evidence_of(robot).find(kSet) != std::string::npos;
    EXPECT_EQ(is_named, before < 1h) << evidence_of(robot);
  }
}

// The operating system says that it is gone.
TEST(TimeHeld, AKilledNodeIsStartedAgain) {
  HalfSimulated simulated;
  TestRobot& robot = simulated.robot;
  simulated.hold(true);
  robot.run_for(5s);
  robot.kill("camera", 60s);
  simulated.hold(false);
  robot.run_for(20s);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
  EXPECT_TRUE(robot.works("camera"));
}

TEST(TimeHeld, NodesThatStaySilentAfterwardsAreJudged) {
  HalfSimulated simulated;
  TestRobot& robot = simulated.robot;
  simulated.hold(true);
  robot.run_for(20s);
  robot["camera"].fault = "redeploy";
  robot.tell(TimeHeld{robot.id("camera"), false}, 10s);
  EXPECT_TRUE(robot.works("camera"));
}

}  // namespace
}  // namespace culprit::test
