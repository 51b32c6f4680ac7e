// When the manager judges a strategy.
#include <gtest/gtest.h>

#include "analyze/analyzer.h"
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
  robot.signal("blur", Value(1.0));
  robot.run_for(700ms);
  return robot;
}

TEST(Verdicts, WaitForAFreshReadingOfASignalThatWasReadOnlyOnce) {
  TestRobot robot = blurred_camera();
  EXPECT_EQ(robot.count("did not resolve"), 0u) << transcript(robot);
  robot.signal("blur", Value(0.0));
  robot.run_for(1s);
  EXPECT_EQ(robot.count("Blurred resolved by focus"), 1u) << transcript(robot);
}

TEST(Verdicts, ComeInTheRhythmOfASignalOnceThatIsKnown) {
  TestRobot robot = blurred_camera();
  robot.signal("blur", Value(1.0));
  robot.run_for(700ms);
  robot.signal("blur", Value(1.0));
  EXPECT_EQ(robot.count("did not resolve"), 0u) << transcript(robot);
  robot.run_for(200ms);
  EXPECT_EQ(robot.count("focus did not resolve Blurred"), 1u) << transcript(robot);
}

TEST(Verdicts, DoNotWaitForEverForASignalThatFellSilent) {
  TestRobot robot = blurred_camera();
  robot.run_for(5s);
  EXPECT_EQ(robot.count("focus did not resolve Blurred"), 1u) << transcript(robot);
}

// Whether it helped cannot be seen for the moment, and after half a minute it did not. Such a failure is looked at
// in each cycle from when it could not be seen any longer: so that one of those is at the very end, STALE is what it is.
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
  EXPECT_EQ(robot.now, deadline + Analyzer::kLostAfter) << transcript(robot);
}

}  // namespace
}  // namespace culprit::test
