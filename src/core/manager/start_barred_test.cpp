// A start that cannot happen is no attempt: it is reported at once and made when it can be.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kBarredRules = R"(
CYCLE 100ms
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER age(/image) > 1s
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
)";

TestRobot robot_without_program() {
  TestRobot robot(kBarredRules);
  robot.add("camera", {}, "/image");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover(6s);
  robot["camera"].start_missing = "there is no program '/opt/robot/camera'";
  return robot;
}

void bring_back(TestRobot& robot) {
  robot["camera"].start_missing.clear();
  robot.tell(StartBarred{robot.id("camera"), ""});
}

TEST(StartBarred, IsReportedOnceWithItsPath) {
  TestRobot robot = robot_without_program();
  robot.kill("camera", 3s);
  EXPECT_EQ(
      robot.count("camera cannot be started: there is no program '/opt/robot/camera'; culprit "
                  "starts it when that is there"),
      1u);
}

TEST(StartBarred, UsesUpNoAttemptHoweverLongItLasts) {
  TestRobot robot = robot_without_program();
  robot.kill("camera", 600s);
  EXPECT_EQ(robot.count("exhausted"), 0u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

TEST(StartBarred, IsMadeAtOnceWhenItCanBe) {
  TestRobot robot = robot_without_program();
  robot.kill("camera", 8s);
  bring_back(robot);
  robot.run_for(2s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
}

TEST(StartBarred, IsFollowedByAllAttemptsThatItsRuleHas) {
  TestRobot robot = robot_without_program();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 8s);
  bring_back(robot);
  robot.run_for(60s);
  EXPECT_GE(robot.count_asked("camera: start process"), 3u);
}

TEST(StartBarred, EndsNoHungProcessThatCouldNotBeStartedAgain) {
  TestRobot robot = robot_without_program();
  robot.tell(StartBarred{robot.id("camera"), robot["camera"].start_missing});
  robot.stop("camera", 10s);
  EXPECT_FALSE(robot.was_asked("camera: stop process"));
}

}  // namespace
}  // namespace culprit::test
