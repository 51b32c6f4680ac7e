// The policies of a rule: FOR, HOLD, COOLDOWN, ON_CHANGE, ATTEMPTS.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

TestRobot one_signal(const std::string& policies) {
  TestRobot robot("COMPONENT c NODE /c\nRULE R\nPOLICIES WARNING " + policies +
                  "\nTRIGGER x > 1\nSTRATEGY s 50 10\nADAPTATION c set_parameter p 1 1\n");
  robot.add("c").parameters["p"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("x", Value(0.0), 1s);
  return robot;
}

TEST(Policies, ForWaitsUntilTheTriggerHeldThatLong) {
  TestRobot robot = one_signal("FOR 500ms");
  robot.signal("x", Value(2.0), 400ms);
  robot.signal("x", Value(0.0), 2s);
  EXPECT_EQ(robot.count("detected"), 0u);
  robot.signal("x", Value(2.0), 600ms);
  EXPECT_EQ(robot.count("detected"), 1u);
}

TEST(Policies, HoldCountsEvaluationsPerCycle) {
  TestRobot robot = one_signal("HOLD 3/5");
  for (int i = 0; i < 2; ++i) {
    robot.signal("x", Value(2.0), 200ms);
    robot.signal("x", Value(0.0), 600ms);
  }
  EXPECT_EQ(robot.count("detected"), 0u);
  robot.signal("x", Value(2.0), 700ms);
  EXPECT_EQ(robot.count("detected"), 1u);
}

TEST(Policies, CooldownKeepsQuietAfterAResolution) {
  TestRobot robot = one_signal("COOLDOWN 10s");
  robot.signal("x", Value(2.0), 50ms);
  robot.signal("x", Value(0.0), 1s);
  EXPECT_EQ(robot.count("resolved"), 1u);
  robot.signal("x", Value(2.0), 5s);
  EXPECT_EQ(robot.count("detected"), 1u);
  robot.run_for(6s);
  EXPECT_EQ(robot.count("detected"), 2u);
}

TEST(Policies, OnChangeActsOnceOnTheRisingEdge) {
  TestRobot robot = one_signal("ON_CHANGE");
  robot.signal("x", Value(2.0), 30s);
  robot.signal("x", Value(3.0), 30s);
  EXPECT_EQ(robot.count("R resolved by s"), 1u);
  EXPECT_EQ(robot.count_asked("set p"), 1u) << "another value is no edge";
  robot.signal("x", Value(0.0), 1s);
  robot.signal("x", Value(2.0), 1s);
  EXPECT_EQ(robot.count_asked("set p"), 2u);
}

TEST(Policies, AttemptsBoundHowOftenStrategiesRun) {
  TestRobot robot = one_signal("ATTEMPTS 2");
  robot.signal("x", Value(2.0), 300s);
  EXPECT_EQ(robot.count("R is exhausted"), 1u);
  EXPECT_EQ(robot.count("s did not resolve R"), 2u);
}

}  // namespace
}  // namespace culprit::test
