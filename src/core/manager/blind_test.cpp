// A rule whose trigger has no value is blind: neither quiet nor failing.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

std::string rule_with(const std::string& trigger, const std::string& policies = "ERROR") {
  return "RULE Low\n  POLICIES " + policies + "\n  TRIGGER " + trigger +
         "\n    STRATEGY s 90 10\n      ADAPTATION driver redeploy 2\n";
}

std::string rules_with(const std::string& signal, const std::string& trigger,
                       const std::string& policies = "ERROR") {
  return "COMPONENT driver NODE /driver LAUNCH \"driver\"\n" + signal + "\n" +
         rule_with(trigger, policies);
}

// The driver runs, and is well.
void show_driver(TestRobot& robot) {
  robot.add("driver", {}, "/battery", 100ms);
  robot.discover();
  robot.tell(EndpointAppeared{"/driver", EndpointKind::kPublisher, "/battery"});
}

// Sends the value once each `period`.
void send(TestRobot& robot, const std::string& signal, const Value& value, Duration time,
          Duration period = 1s) {
  for (Duration passed{}; passed < time; passed += period) {
    robot.signal(signal, value, period);
  }
}

const std::optional<Blind>& blind(TestRobot& robot, std::size_t rule = 0) {
  return robot.manager().knowledge().blindness[RuleId(rule)];
}

TEST(Blind, ARenamedKeyIsToldOnceWithItsReasonAndTheNearestName) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge", "battery < 0.2"));
  show_driver(robot);
  robot.tell(StatusHeard{"power", "p1", {"charge_ratio", "charges", "voltage"}}, 9s);
  EXPECT_FALSE(blind(robot)) << "it has its time for a first value";
  robot.run_for(600s);
  EXPECT_EQ(robot.count("Low is blind: signal battery was never seen; did you mean 'charges'?"),
            1u);
  EXPECT_EQ(robot.count("is blind"), 1u);
  EXPECT_EQ(robot.manager().knowledge().blind_since(RuleId(0)), Time{});
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Blind, ATopicThatNobodyPublishesMakesItsRuleBlind) {
  TestRobot robot(rules_with("", "age(/batery) > 1s"));
  show_driver(robot);
  robot.run_for(60s);
  EXPECT_EQ(robot.count("Low is blind: /batery was never seen; did you mean '/battery'?"), 1u);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Blind, AComponentThatWasNeverStartedIsToldOnce) {
  TestRobot robot(
      "COMPONENT driver NODE /driver LAUNCH \"driver\"\n"
      "COMPONENT arm NODE /arm LAUNCH \"arm\"\n" +
      rule_with("!alive(arm) || lifecycle(arm) != \"active\""));
  show_driver(robot);
  robot.run_for(3600s);
  EXPECT_EQ(robot.count("Low is blind: arm was never seen"), 1u);
  EXPECT_TRUE(robot.asked.empty());
}

// Silence of a signal with STALE: the last reading, its STALE, and the time that is left for the next.
TEST(Blind, AStaleSignalMakesItsRuleBlindUntilItComesAgainForAWhile) {
  TestRobot robot(
      rules_with("SIGNAL battery DIAGNOSTIC power KEY charge STALE 2s", "battery < 0.2"));
  show_driver(robot);
  send(robot, "battery", Value(0.9), 20s);
  robot.run_for(5s);
  EXPECT_FALSE(blind(robot)) << "it may only be late";
  robot.run_for(10s);
  EXPECT_EQ(robot.count("Low is blind: no new value of battery comes"), 1u);
  ASSERT_TRUE(blind(robot));
  EXPECT_EQ(blind(robot)->since, Time(19s)) << "its last value came then";
  robot.run_for(300s);
  robot.signal("battery", Value(0.9), 10s);
  EXPECT_TRUE(blind(robot)) << "one value is no sight";
  send(robot, "battery", Value(0.9), 10s);
  EXPECT_FALSE(blind(robot));
  EXPECT_EQ(robot.count("Low can be evaluated again"), 1u);
  EXPECT_EQ(robot.count("is blind"), 1u);
}

// Without STALE its last value would count for ever.
TEST(Blind, ADiagnosticThatCeasesMakesItsRuleBlind) {
  for (const char* trigger : {"battery < 0.2", "level(power) > 1"}) {
    TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge", trigger));
    show_driver(robot);
    for (int i = 0; i < 20; ++i) {
      robot.signal("battery", Value(0.9));
      if (!robot.rules().diagnostics.empty()) robot.tell(DiagnosticRead{DiagnosticId(0), 0});
      robot.run_for(1s);
    }
    robot.run_for(9s);
    EXPECT_FALSE(blind(robot)) << trigger;
    robot.run_for(20s);
    EXPECT_EQ(robot.count("Low is blind: no new value of "), 1u) << trigger;
    robot.run_for(600s);
    EXPECT_EQ(robot.count("is blind"), 1u) << trigger;
    EXPECT_TRUE(robot.asked.empty()) << trigger;
  }
}

// One that is sent on change only pauses as it likes.
TEST(Blind, ADiagnosticOfAFewValuesIsNotExpectedToComeAgain) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge", "battery < 0.2"));
  show_driver(robot);
  robot.signal("battery", Value(0.9), 3600s);
  EXPECT_FALSE(blind(robot));
}

TEST(Blind, AFieldOfATopicThatNobodyPublishesAnyMoreDoesNotCount) {
  TestRobot robot(
      "COMPONENT driver NODE /driver LAUNCH \"driver\"\nCOMPONENT gauge NODE /gauge\n"
      "SIGNAL battery TOPIC /charge FIELD percentage\n" +
      rule_with("battery < 0.2"));
  show_driver(robot);
  robot.add("gauge", {}, "/charge", 1s);
  robot.discover();
  robot.tell(EndpointAppeared{"/gauge", EndpointKind::kPublisher, "/charge"}, 1s);
  robot.signal("battery", Value(0.9), 120s);
  EXPECT_FALSE(blind(robot)) << "it may be sent on change";
  robot.kill("gauge", 30s);
  EXPECT_EQ(robot.count("Low is blind: no new value of battery comes"), 1u);
}

TEST(Blind, ATriggerThatOtherInputsDecideCanSee) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge",
                             "alive(driver) == false && "
                             "battery < 0.2"));
  show_driver(robot);
  robot.run_for(60s);
  EXPECT_FALSE(blind(robot));
}

// A node that is inactive in one mode and active in another: its signal comes and goes.
TEST(Blind, AnInputThatComesAndGoesReportsFewEvents) {
  TestRobot robot(
      rules_with("SIGNAL battery DIAGNOSTIC power KEY charge STALE 2s", "battery < 0.2"));
  show_driver(robot);
  for (int i = 0; i < 120; ++i) {
    send(robot, "battery", Value(0.9), 15s);
    robot.run_for(15s);
  }
  EXPECT_LE(robot.count("is blind"), 3u);
  EXPECT_GE(robot.count("is blind"), 1u);
  EXPECT_TRUE(blind(robot)) << "it cannot see half of the time";
  send(robot, "battery", Value(0.9), 600s);
  EXPECT_FALSE(blind(robot));
}

TEST(Blind, AShortGapIsNone) {
  TestRobot robot(
      rules_with("SIGNAL battery DIAGNOSTIC power KEY charge STALE 2s", "battery < 0.2"));
  show_driver(robot);
  for (int i = 0; i < 20; ++i) {
    send(robot, "battery", Value(0.9), 10s);
    robot.run_for(5s);
  }
  EXPECT_EQ(robot.count("is blind"), 0u);
}

// Unknown is no proof that a failure is gone, and none that it is there.
TEST(Blind, AFailureWhoseTriggerBecomesUnknownIsNotResolved) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge STALE 2s", "battery < 0.2",
                             "ERROR ATTEMPTS 1"));
  show_driver(robot);
  send(robot, "battery", Value(0.9), 10s);
  robot.order({1, "Ann", "", Silence{RuleId(0), std::nullopt}});
  send(robot, "battery", Value(0.1), 5s);
  EXPECT_EQ(robot.count("Low detected"), 1u);
  robot.run_for(120s);
  EXPECT_EQ(robot.count("Low is blind: no new value of battery comes"), 1u);
  EXPECT_EQ(robot.count("resolved"), 0u);
  EXPECT_EQ(robot.count("cleared without a repair"), 0u);
  EXPECT_EQ(robot.count("Low can no longer be evaluated"), 1u);
  EXPECT_TRUE(blind(robot)) << "it reads as blind, not as quiet";
  robot.order({2, "Ann", "", LiftSilence{RuleId(0)}}, 60s);
  EXPECT_TRUE(robot.asked.empty()) << "nothing is begun on unknown";
}

TEST(Blind, NaNMakesARuleBlind) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge", "battery < 0.2"));
  show_driver(robot);
  send(robot, "battery", Value(std::string("nan")), 30s);
  EXPECT_EQ(robot.count("Low is blind: the values of battery cannot be compared (NaN, or another "
                        "type)"),
            1u);
}

TEST(Blind, ADivisionByZeroMakesARuleBlind) {
  TestRobot robot(rules_with("SIGNAL a DIAGNOSTIC power KEY a\nSIGNAL b DIAGNOSTIC power KEY b",
                             "a / b > 2.0"));
  show_driver(robot);
  for (int i = 0; i < 30; ++i) {
    robot.signal("a", Value(1.0));
    robot.signal("b", Value(0.0), 1s);
  }
  EXPECT_EQ(robot.count("Low is blind: its trigger has no result"), 1u);
}

// A window that is only not covered yet has the time of its window.
TEST(Blind, AWindowThatIsNotCoveredYetIsNoReason) {
  TestRobot robot(rules_with("", "rate(/battery, 30s) < 5"));
  show_driver(robot);
  robot.run_for(120s);
  EXPECT_EQ(robot.count("is blind"), 0u);
}

// A message that could not be received is not missing.
TEST(Blind, DeafnessMakesNoRuleBlind) {
  TestRobot robot(rules_with("SIGNAL battery DIAGNOSTIC power KEY charge", "battery < 0.2"));
  show_driver(robot);
  send(robot, "battery", Value(0.9), 20s);
  robot.tell(HearingLost{"its own heartbeat does not come"}, 300s);
  robot.tell(HearingRegained{}, 3s);
  send(robot, "battery", Value(0.9), 60s);
  EXPECT_EQ(robot.count("is blind"), 0u);
}

TEST(Blind, ARobotThatNobodySeesIsWatchedByNoRule) {
  TestRobot robot(rules_with("", "age(/battery) > 1s"));
  robot.run_for(4s);
  EXPECT_FALSE(robot.manager().knowledge().blindness.is_total());
  robot.run_for(20s);
  EXPECT_TRUE(robot.manager().knowledge().blindness.is_total());
  show_driver(robot);
  robot.run_for(30s);
  EXPECT_FALSE(robot.manager().knowledge().blindness.is_total());
  EXPECT_EQ(robot.count("Low can be evaluated again"), 1u);
}

}  // namespace
}  // namespace culprit::test
