// When the manager judges a strategy.
#include <gtest/gtest.h>

#include "analyze/due_verdicts.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

// A signal that is refreshed seldom, as by a blackboard, and that appears with its first alarm.
constexpr const char* kFocus = R"(
CYCLE 40ms
COMPONENT camera NODE /camera
RULE Blurred
  POLICIES WARNING
  TRIGGER blur > 0
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter focus 1 2
    STRATEGY more 50 10
      ADAPTATION camera set_parameter focus 2 2
)";

TestRobot blurred_camera() {
  TestRobot robot(kFocus);
  robot.add("camera").parameters["focus"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("blur", Value(1.0), 700ms);
  return robot;
}

TEST(Verdicts, WaitForAFreshReadingOfASignalThatWasReadOnlyOnce) {
  TestRobot robot = blurred_camera();
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  robot.signal("blur", Value(0.0), 1s);
  EXPECT_EQ(robot.count("Blurred resolved by focus"), 1u);
}

TEST(Verdicts, ComeInTheRhythmOfASignalOnceThatIsKnown) {
  TestRobot robot = blurred_camera();
  robot.signal("blur", Value(1.0), 700ms);
  robot.signal("blur", Value(1.0));
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  robot.run_for(200ms);
  EXPECT_EQ(robot.count("focus did not resolve Blurred"), 1u);
}

TEST(Verdicts, DoNotWaitForEverForASignalThatFellSilent) {
  TestRobot robot = blurred_camera();
  robot.run_for(5s);
  EXPECT_EQ(robot.count("focus did not resolve Blurred"), 1u);
}

// Whether it helped is unknown for half a minute, and then it did not. Such a failure is looked at in each cycle from
// the moment when it is unknown: STALE is chosen so that one of those looks is at the very end.
TEST(Verdicts, WaitHalfAMinuteForASignalThatIsNotKnownAnyLonger) {
  TestRobot robot(R"(
CYCLE 40ms
SIGNAL blur DIAGNOSTIC camera KEY blur STALE 95ms
COMPONENT camera NODE /camera
RULE Blurred
  POLICIES WARNING
  TRIGGER blur > 0
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter focus 1 10
)");
  robot.add("camera").parameters["focus"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("blur", Value(1.0));
  Time deadline = kNever;
  while (robot.count("focus did not resolve Blurred") == 0 && robot.now < Time(60s)) {
    const auto& attempt = robot.manager().knowledge().states[RuleId(0)].attempt;
    if (attempt) deadline = attempt->deadline;
    robot.run_for(1ms);
  }
  EXPECT_EQ(robot.now, deadline + DueVerdicts::kLostAfter);
}

// ---- what was started has to find what it reads

constexpr const char* kTwoInARow = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT detector NODE /detector LAUNCH "detector"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/image) > 500ms
    STRATEGY camera_again 90 10
      ADAPTATION camera redeploy 5
RULE DetectorSilent
  POLICIES ERROR
  TRIGGER age(/objects) > 500ms
    STRATEGY detector_again 90 10
      ADAPTATION detector redeploy 5
)";

Manager::Options finding_within(Duration time) {
  Manager::Options options;
  options.governor.limits.quiet_downstream = time;
  return options;
}

// A pipeline on which this one stopped to publish.
TestRobot two_in_a_row(const std::string& broken) {
  TestRobot robot(kTwoInARow, std::make_unique<BayesPlanner>(), finding_within(3500ms));
  robot.add("camera", {}, "/image");
  robot.add("detector", {}, "/objects").hears = {"camera"};
  robot.discover(3s);
  robot[broken].fault = "nobody knows what";
  return robot;
}

// From when it took effect to when it was said not to have helped.
Duration verdict_of(const TestRobot& robot) {
  Time done = kNever;
  for (const Event& event : robot.events) {
    if (std::holds_alternative<AdaptationDone>(event.what)) done = std::min(done, event.at);
    if (std::holds_alternative<StrategyFailed>(event.what)) return event.at - done;
  }
  return Duration::zero();
}

TEST(Verdicts, OnWhatWasStartedWaitUntilItCanHaveHeardWhatItReads) {
  TestRobot robot = two_in_a_row("detector");
  robot.run_for(8s);
  EXPECT_GE(verdict_of(robot), 3400ms);
  EXPECT_LE(verdict_of(robot), 4s);
}

TEST(Verdicts, OnWhatWasStartedAndReadsNothingDoNot) {
  TestRobot robot = two_in_a_row("camera");
  robot.run_for(8s);
  EXPECT_GE(verdict_of(robot), 1s);
  EXPECT_LE(verdict_of(robot), 1500ms);
}

// As long as Fast DDS may take to match it.
TEST(Verdicts, DoNotCountAWellNodeAsFailedThatFindsWhatItReadsLate) {
  TestRobot robot = two_in_a_row("detector");
  robot.run_for(1s);
  ASSERT_EQ(robot.count("redeploy detector: done"), 1u);
  robot.run_for(2500ms);
  robot["detector"].fault.clear();
  robot.run_for(1s);
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  EXPECT_EQ(robot.count("DetectorSilent resolved by detector_again"), 1u);
  EXPECT_EQ(robot.count_asked("detector: start process"), 1u);
}

TEST(Verdicts, DoNotWaitForEverForWhatIsNotThere) {
  TestRobot robot = two_in_a_row("detector");
  robot["camera"].dies_at_start = true;
  robot.run_for(1s);
  ASSERT_EQ(robot.count("redeploy detector: done"), 1u);
  robot.kill("camera", 12s);
  EXPECT_EQ(robot.count("detector_again did not resolve"), 0u);
  robot.run_for(3s);
  EXPECT_EQ(robot.count("detector_again did not resolve"), 1u);
}

}  // namespace
}  // namespace culprit::test
