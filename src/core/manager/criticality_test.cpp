// The lower criticality never delays the higher.
#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

// Two failures of one component; the adaptation against the lesser one is `focus`.
std::string rules(const std::string& focus) {
  return R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 90 10
      ADAPTATION camera )" +
         focus + R"(
RULE Dark
  POLICIES ERROR
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION camera set_parameter on 1 5
)";
}

// Each signal is read once a second: so long one would wait for a fresh reading.
TestRobot camera(const std::string& focus) {
  TestRobot robot(rules(focus));
  robot.add("camera").parameters = {{"on", Value(std::int64_t{0})},
                                    {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (int i = 0; i < 3; ++i) {
    robot.signal("blur", Value(0.0));
    robot.signal("brightness", Value(1.0), 1s);
  }
  return robot;
}

// It has its components back only when it has all of them.
TEST(Criticality, AFailureThatYieldedIsNotJudgedWhileAnyOfItsComponentsIsTaken) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT lamp NODE /lamp
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter angle 1 5
      ADAPTATION lamp set_parameter angle 1 5
RULE Dark
  POLICIES ERROR
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION camera set_parameter on 1 20
)");
  for (const char* name : {"camera", "lamp"})
    robot.add(name).parameters = {{"on", Value(std::int64_t{0})},
                                  {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (int i = 0; i < 3; ++i) {
    robot.signal("blur", Value(0.0));
    robot.signal("brightness", Value(1.0), 1s);
  }
  robot.signal("blur", Value(1.0), 100ms);
  ASSERT_EQ(robot.count("set angle of lamp: done"), 1u);
  robot.signal("brightness", Value(0.2), 100ms);
  ASSERT_EQ(robot.count("Blurred.focus is abandoned: camera is needed for Dark"), 1u);
  robot.signal("blur", Value(0.0), 1s);
  EXPECT_EQ(robot.count("Blurred cleared without a repair of its own"), 1u)
      << "the light may have helped";
}

TEST(Criticality, LetsNoErrorWaitForAVerdictOnALesserFailure) {
  TestRobot robot = camera("set_parameter angle 1 5");
  const StrategyId focus = robot.rules().rules[0].strategies.front();
  const Belief before = robot.manager().knowledge().beliefs[focus];
  robot.signal("blur", Value(1.0), 100ms);
  ASSERT_EQ(robot.count("set angle of camera: done"), 1u);
  robot.signal("brightness", Value(0.2));
  EXPECT_EQ(robot.count("Blurred.focus is abandoned: camera is needed for Dark"), 1u);
  EXPECT_EQ(robot.count("camera is held responsible for Dark"), 1u);
  EXPECT_EQ(robot.manager().knowledge().beliefs[focus], before) << "nobody saw whether it helped";
  robot.run_for(100ms);
  robot.signal("brightness", Value(1.0), 1s);
  EXPECT_EQ(robot.count("Dark resolved by light"), 1u);
  robot.run_for(200ms);
  robot.signal("blur", Value(0.0), 3s);
  EXPECT_EQ(robot.count("Blurred resolved by focus"), 1u);
  EXPECT_EQ(robot.count_asked("camera: set angle"), 1u) << "it had taken effect";
  EXPECT_EQ(robot.manager().knowledge().beliefs[focus], before) << "either may have helped";
}

TEST(Criticality, LetsALesserStrategyThatGaveWayFailIfItDidNotHelp) {
  TestRobot robot = camera("set_parameter angle 1 5");
  robot.signal("blur", Value(1.0), 100ms);
  robot.signal("brightness", Value(0.2), 100ms);
  robot.signal("brightness", Value(1.0), 1500ms);
  robot.signal("blur", Value(1.0), 4s);
  EXPECT_EQ(robot.count("focus did not resolve Blurred"), 1u);
  EXPECT_EQ(robot.count_asked("camera: set angle to 0"), 1u) << "and is undone";
}

// The process that it was set in is replaced.
TEST(Criticality, LetsALesserStrategyThatWasTakenBackBeTriedAgain) {
  std::string text = rules("set_parameter angle 1 5");
  text.replace(text.find("set_parameter on 1 5"), 20, "redeploy 5");
  TestRobot robot(text);
  robot.add("camera").parameters["angle"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("blur", Value(1.0));
  robot.signal("brightness", Value(1.0), 100ms);
  robot.signal("brightness", Value(0.2), 1s);
  robot.signal("brightness", Value(1.0), 3s);
  robot.signal("blur", Value(1.0), 3s);
  EXPECT_EQ(robot.count("camera is held responsible for Blurred"), 2u);
}

TEST(Criticality, LetsAnErrorWaitUntilTheAdaptationOfALesserFailureIsDone) {
  TestRobot robot = camera("redeploy 5");
  robot.signal("blur", Value(1.0));
  robot.signal("brightness", Value(0.2), 100ms);
  EXPECT_EQ(robot.count("Dark waits: camera is being adapted"), 1u);
  EXPECT_EQ(robot.count("camera is held responsible for Dark"), 0u);
}

TEST(Criticality, WhyAFailureWaitsIsSaidAnewWhenTheReasonOrTheFailureIsAnother) {
  TestRobot robot = camera("redeploy 5");
  const auto reasons = [&] {
    std::vector<Condition> all;
    for (const Event& event : robot.events) {
      const auto* waits = std::get_if<FailureHeldBack>(&event.what);
      if (waits != nullptr && robot.rules()[waits->rule].name == "Dark")
        all.push_back(*waits->candidates.front().excluded);
    }
    return all;
  };
  robot.signal("blur", Value(1.0));
  robot.signal("brightness", Value(0.2), 100ms);
  EXPECT_EQ(reasons(), std::vector{Condition::kAdapting}) << "once";
  const RuleId dark = robot.rules().rules.front().name == "Dark" ? RuleId(0) : RuleId(1);
  robot.order({1, "Ann", "", Silence{dark, {}}}, 4s);
  EXPECT_EQ(reasons(), (std::vector{Condition::kAdapting, Condition::kWithheld}));
  robot.signal("brightness", Value(1.0), 4s);
  robot.signal("brightness", Value(0.2), 1s);
  EXPECT_EQ(reasons(),
            (std::vector{Condition::kAdapting, Condition::kWithheld, Condition::kWithheld}));
}

TEST(Criticality, LetsNoErrorWaitForALesserFailureToSettle) {
  TestRobot robot = camera("redeploy 5");
  robot.signal("blur", Value(1.0));
  robot.signal("brightness", Value(0.2), 10ms);
  robot.signal("blur", Value(0.0), 800ms);
  EXPECT_EQ(robot.count("Blurred resolved by focus"), 1u);
  EXPECT_EQ(robot.count("camera is held responsible for Dark"), 1u);
}

// The paper's planner leaves to a strategy what it has until the verdict.
TEST(Criticality, LetsNoErrorWaitForAVerdictThatNobodyCanGive) {
  TestRobot robot(R"(
COMPONENT fusion NODE /fusion
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy STALE 500ms
RULE Bad
  POLICIES WARNING
  TRIGGER entropy > 0.5
    STRATEGY recalibrate 90 10
      ADAPTATION fusion set_parameter offset 1 5
RULE Dead
  POLICIES ERROR
  TRIGGER silence > 0.5
    STRATEGY reset 90 10
      ADAPTATION fusion set_parameter on 1 5
)",
                  std::make_unique<PaperPlanner>());
  robot.add("fusion").parameters = {{"on", Value(std::int64_t{0})},
                                    {"offset", Value(std::int64_t{0})}};
  robot.discover();
  for (int i = 0; i < 10; ++i) {
    robot.signal("entropy", Value(i < 8 ? 0.0 : 1.0));
    robot.signal("silence", Value(0.0), 200ms);
  }
  EXPECT_EQ(robot.count("fusion is held responsible for Bad"), 1u);
  robot.signal("silence", Value(1.0));  // so the entropy is not received any longer
  robot.run_for(3s);
  EXPECT_EQ(robot.count("recalibrate did not resolve Bad: it is unknown"), 1u);
  EXPECT_EQ(robot.count("fusion is held responsible for Dead"), 1u);
}

// A camera that no consumer misses for a second, and a rule by which the robot is blind at once.
constexpr const char* kBlind = R"(
COMPONENT camera       NODE /camera       LAUNCH "camera"
COMPONENT segmentation NODE /segmentation LAUNCH "segmentation"
RULE CameraDead
  POLICIES WARNING FOR 1s
  TRIGGER !alive(camera)
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE Blind
  POLICIES ERROR
  TRIGGER age(/segmentation) > 350ms
    STRATEGY restart 60 10
      ADAPTATION segmentation restart 3
    STRATEGY redeploy 90 10
      ADAPTATION segmentation redeploy 10
)";

TestRobot blind(std::unique_ptr<const Planner> planner = std::make_unique<BayesPlanner>()) {
  TestRobot robot(kBlind, std::move(planner));
  robot.add("camera", {}, "/rgb");
  robot.add("segmentation", {"camera"}, "/segmentation");
  robot.discover(2s);
  return robot;
}

TEST(Criticality, OfACauseIsThatOfTheWorstFailureThatItExplains) {
  TestRobot robot = blind();
  robot.kill("camera", 1100ms);
  EXPECT_EQ(robot.count("camera is held responsible for CameraDead"), 1u);
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("segmentation:")) << "it was never ill";
}

// They take 300 ms each, and the upstream one is back before the verdict on the one that depends on
// it.
TEST(Criticality, LetsTheDeadBeReplacedSideBySide) {
  TestRobot robot = blind();
  robot.kill("camera");
  robot.kill("segmentation", 1100ms);
  EXPECT_TRUE(robot.was_asked("camera: start"));
  EXPECT_TRUE(robot.was_asked("segmentation: start"));
  robot.run_for(1s);
  EXPECT_TRUE(robot.works("segmentation"));
  robot.run_for(10s);
  EXPECT_EQ(robot.count_asked(": start"), 2u);
}

}  // namespace
}  // namespace culprit::test
