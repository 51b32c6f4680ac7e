// Lost is not silent: the link is at fault, and no healthy node is taken down for that.
#include <random>

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kLossRules = R"(
CYCLE 100ms
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/image) > 350ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionSilent
  POLICIES ERROR
  TRIGGER age(/fused) > 350ms
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
)";

struct Loss : testing::Test {
  // Both publish at 10 Hz. `share` of that is lost.
  TestRobot robot_with_loss(double share) {
    TestRobot robot(kLossRules);
    robot.add("camera", {}, "/image");
    robot.add("fusion", {"camera"}, "/fused");
    robot.discover();
    robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/image"});
    robot.tell(EndpointAppeared{"/fusion", EndpointKind::kPublisher, "/fused"}, 6s);
    // culprit learns from the first lost messages that the network goes bad.
    robot.loses = [this](const std::string&) { return std::bernoulli_distribution(0.1)(random_); };
    robot.run_for(5s);
    robot.loses = [this, share](const std::string&) {
      return std::bernoulli_distribution(share)(random_);
    };
    return robot;
  }

 private:
  std::mt19937 random_{1};
};

TEST_F(Loss, OfAFifthTakesNothingDown) {
  TestRobot robot = robot_with_loss(0.2);
  robot.run_for(600s);
  EXPECT_GT(robot.count("Silent detected"), 0u) << "there were pauses: ";
  EXPECT_FALSE(robot.was_asked("stop process"));
}

TEST_F(Loss, IsWhatIsHeldResponsible) {
  TestRobot robot = robot_with_loss(0.4);
  robot.run_for(60s);
  EXPECT_GT(robot.count("is lost on the way to culprit: the network or a host is at fault"), 0u);
  EXPECT_FALSE(robot.was_asked("stop process"));
}

TEST_F(Loss, HidesNoDeath) {
  TestRobot robot = robot_with_loss(0.4);
  robot.run_for(20s);
  robot.kill("camera", 3s);
  EXPECT_TRUE(robot.works("camera"));
}

TEST_F(Loss, ExplainsNoSilenceThatGoesOn) {
  TestRobot robot = robot_with_loss(0.2);
  robot.run_for(20s);
  robot.fail("camera", "redeploy", 10s);
  EXPECT_TRUE(robot.works("camera"));
}

}  // namespace
}  // namespace culprit::test
