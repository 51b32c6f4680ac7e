// Failures that an exhausted one explains wait for a person with it.
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

std::unique_ptr<const Planner> paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> bayes() { return std::make_unique<BayesPlanner>(); }

class ExhaustedCause : public testing::TestWithParam<PlannerFactory> {};
INSTANTIATE_TEST_SUITE_P(EachPlanner, ExhaustedCause, testing::Values(paper, bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

std::string node(int i) { return "c" + std::to_string(i); }

std::string rule(int i, int attempts = 2) {
  return "COMPONENT " + node(i) + " NODE /" + node(i) + " LAUNCH \"" + node(i) + "\"\nRULE Silent" +
         std::to_string(i) + "\nPOLICIES ERROR ATTEMPTS " + std::to_string(attempts) +
         "\nTRIGGER age(/" + node(i) + ") > 350ms\nSTRATEGY restart 50 10\nADAPTATION " + node(i) +
         " restart 3\nSTRATEGY redeploy 90 10\nADAPTATION " + node(i) + " redeploy 10\n";
}

// A chain of five whose first only a person can fix.
TEST_P(ExhaustedCause, LeavesItsEffectsToThePersonToo) {
  std::string rules;
  for (int i = 0; i < 5; ++i) rules += rule(i);
  TestRobot robot(rules, GetParam()());
  for (int i = 0; i < 5; ++i) {
    const std::vector<std::string> needs =
        i == 0 ? std::vector<std::string>{} : std::vector{node(i - 1)};
    robot.add(node(i), needs, "/" + node(i));
  }
  robot.discover(2s);
  robot.fail("c0", "a person", 120s);
  EXPECT_EQ(robot.count("Silent0 is exhausted"), 1u);
  for (int i = 1; i < 5; ++i) EXPECT_FALSE(robot.was_asked(node(i) + ":"));
  EXPECT_EQ(robot.count("is exhausted"), 1u) << "once is enough";
  robot["c0"].fault.clear();
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("c4"));
  EXPECT_EQ(robot.count("cleared without a repair of its own"), 5u);
}

// An effect may have a fault of its own, which shows once the cause is repaired.
TEST_P(ExhaustedCause, LetsItsEffectsBeRepairedOnceItIsGone) {
  TestRobot robot(rule(0) + rule(1), GetParam()());
  robot.add("c0", {}, "/c0");
  robot.add("c1", {"c0"}, "/c1");
  robot.discover(2s);
  robot["c0"].fault = "a person";
  robot.fail("c1", "redeploy", 60s);
  EXPECT_FALSE(robot.was_asked("c1:"));
  robot["c0"].fault.clear();
  robot.run_for(30s);
  EXPECT_TRUE(robot.works("c1"));
}

// c1 can only be focused, which makes no sense while it is down. Rounds in which nothing could be
// tried are no attempts: once it is back, it is focused.
TEST_P(ExhaustedCause, IsNoFailureThatWaitsUntilItsComponentIsRepaired) {
  for (const bool is_by_person : {false, true}) {
    TestRobot robot(
        rule(1, is_by_person ? 2 : 9) +
            "RULE Blurred\nPOLICIES NON_CRITICAL ATTEMPTS 2\nTRIGGER blur > 0.5\nSTRATEGY focus "
            "80 10\nADAPTATION c1 set_parameter angle 1 2\n",
        GetParam()());
    robot.add("c1", {}, "/c1").parameters["angle"] = Value(std::int64_t{0});
    robot.discover(2s);
    robot["c1"].dies_at_start = true;
    robot.kill("c1");
    robot.signal("blur", Value(1.0), is_by_person ? 300s : 30s);
    EXPECT_EQ(robot.count("Silent1 is exhausted"), is_by_person ? 1u : 0u);
    EXPECT_EQ(robot.count("Blurred is exhausted"), 0u);
    EXPECT_FALSE(robot.was_asked("c1: set"));
    robot["c1"].dies_at_start = false;
    if (is_by_person) robot.start_by_hand("c1");
    robot.run_for(120s);
    EXPECT_TRUE(robot.was_asked("c1: set"));
  }
}

// No strategy repairs c1, so the exhaustion of its consumers is reported to a person.
TEST_P(ExhaustedCause, IsAConsumerOfAnUnrepairedComponent) {
  TestRobot robot(
      "COMPONENT c1 NODE /c1\nRULE Blurred\nPOLICIES NON_CRITICAL ATTEMPTS 2\nTRIGGER blur > "
      "0.5\nSTRATEGY focus 80 10\nADAPTATION c1 set_parameter angle 1 2\n",
      GetParam()());
  robot.add("c1", {}, "/c1");
  robot.discover(2s);
  robot.signal("blur", Value(1.0));
  robot.kill("c1", 120s);
  EXPECT_EQ(robot.count("Blurred is exhausted"), 1u);
}

// A bad value of c1, which one reconfiguration may mend.
constexpr const char* kBlurred =
    "RULE Blurred\nPOLICIES NON_CRITICAL\nTRIGGER blur > 0.5\nSTRATEGY focus 80 10 WHEN is_tunable "
    "> 0.5\nADAPTATION c1 set_parameter angle 1 2\n";

// One reconfiguration may be tried; what made no sense when its turn came was not tried.
TEST(Exhausted, LetsAReconfigurationBeTriedThatMadeNoSenseBefore) {
  TestRobot robot(rule(0) + rule(1) + kBlurred);
  robot.add("c0", {}, "/c0");
  robot.add("c1", {"c0"}, "/c1").parameters["angle"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("is_tunable", Value(0.0), 2s);
  robot.signal("blur", Value(1.0));
  robot.fail("c0", "a person", 500ms);
  ASSERT_EQ(robot.count("Blurred waits: focus is not possible now"), 1u);
  robot.signal("is_tunable", Value(1.0), 1500ms);
  ASSERT_FALSE(robot.was_asked("c1: set angle"));
  robot.run_for(120s);
  ASSERT_EQ(robot.count("Silent0 is exhausted"), 1u);
  EXPECT_EQ(robot.count_asked("c1: set angle to 1"), 1u);
}

// Yielding to a failure that awaits a human would block this one silently.
TEST(Exhausted, WhatWaitsForAPersonHoldsUpNoLesserFailure) {
  TestRobot robot(rule(0) + rule(2) + "COMPONENT c1 NODE /c1\n" + kBlurred);
  robot.add("c0", {}, "/c0");
  robot.add("c1", {}, "/c1").parameters["angle"] = Value(std::int64_t{0});
  robot.add("c2", {"c0", "c1"}, "/c2");
  robot.discover();
  robot.signal("is_tunable", Value(1.0));
  robot.signal("blur", Value(0.0), 2s);
  robot.fail("c0", "a person", 60s);
  ASSERT_EQ(robot.count("Silent0 is exhausted"), 1u);
  robot.signal("blur", Value(1.0), 5s);
  EXPECT_TRUE(robot.was_asked("c1: set angle to 1"));
}

// A feedback loop of three, one of which dies and does not come up again.
TEST(Exhausted, LeavesTheCircleOfWhatIsDeadToThePersonToo) {
  TestRobot robot(rule(0) + rule(1) + rule(2));
  robot.add("c0", {"c2"}, "/c0").dies_at_start = true;
  robot.add("c1", {"c0"}, "/c1");
  robot.add("c2", {"c1"}, "/c2");
  robot.discover(2s);
  robot.kill("c0", 240s);
  EXPECT_EQ(robot.count("Silent0 is exhausted"), 1u);
  EXPECT_FALSE(robot.was_asked("c1:"));
  EXPECT_FALSE(robot.was_asked("c2:"));
}

// The robot stops at once when no strategy is left for the camera.
TEST_P(ExhaustedCause, MakesTheRobotStopSafely) {
  TestRobot robot(rule(0) +
                      "COMPONENT drive NODE /drive\nRULE Blind\nPOLICIES ERROR\nTRIGGER "
                      "age(/drive) > 350ms\nSTRATEGY restart 50 10\nADAPTATION drive restart "
                      "3\nSTRATEGY halt 99 10 LASTRESORT\nADAPTATION drive set_parameter speed "
                      "0 1\n",
                  GetParam()());
  robot.add("c0", {}, "/c0");
  robot.add("drive", {"c0"}, "/drive").parameters["speed"] = Value(std::int64_t{1});
  robot.discover(2s);
  robot.fail("c0", "a person", 60s);
  EXPECT_EQ(robot["drive"].parameters["speed"], Value(std::int64_t{0}));
  EXPECT_FALSE(robot.was_asked("drive: deactivate"));
}

}  // namespace
}  // namespace culprit::test
