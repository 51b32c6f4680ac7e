// Windows from end to end: when a rule acts on them, and when it must not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Plays observations to a manager that only advises, as a recording is replayed, and collects when
// each rule was detected.
class Played {
 public:
  explicit Played(const std::string& rules)
      : rules_(*check(Source("test.rules", rules)).rules),
        manager_(rules_, std::make_unique<BayesPlanner>(), {.autonomy = Autonomy::kAdvise}) {}

  template <class... What>
  void observe(Duration at, What... what) {
    const Time now(at);
    wait_until(at);
    const std::vector<Observation> observations{{now, std::move(what)}...};
    manager_.step(now, observations);
    note();
  }
  void wait_until(Duration at) {
    while (manager_.next_deadline() < Time(at)) {
      manager_.step(manager_.next_deadline(), {});
      note();
    }
  }

  std::vector<std::pair<std::string, Duration>> detected;

 private:
  void note() {
    for (const Event& event : manager_.events()) {
      if (const auto* found = std::get_if<FailureDetected>(&event.what))
        detected.emplace_back(rules_[found->rule].name, event.at.time_since_epoch());
    }
  }
  RuleSet rules_;
  Manager manager_;
};

TEST(Windows, SeeAllOfALongTimeOfAFastSignal) {
  Played played(
      "SIGNAL x TOPIC /x FIELD data\n"
      "RULE Min\nPOLICIES WARNING REPORT\nTRIGGER min(x, 25s) > 0.5\n"
      "RULE Mean\nPOLICIES WARNING REPORT\nTRIGGER mean(x, 25s) > 0.8\n");
  for (int i = 0; i < 200 * 32; ++i)
    played.observe(5ms * i, SignalRead{SignalId(0), Value(i < 600 ? 0.0 : 1.0)});
  EXPECT_THAT(played.detected, ElementsAre(std::pair("Mean", 25s), std::pair("Min", 27995ms)));
}

TEST(Windows, ARateIsExactHoweverManyMessagesThereAre) {
  Played played(
      "RULE TooFast\nPOLICIES WARNING REPORT\nTRIGGER rate(/x, 30s) > 1000\n"
      "RULE TooSlow\nPOLICIES WARNING REPORT\nTRIGGER rate(/x, 30s) < 999\n");
  for (int i = 0; i < 80000; ++i) played.observe(1ms * i, SampleArrived{TopicId(0), 1});
  EXPECT_THAT(played.detected, IsEmpty());
  played.wait_until(90s);
  EXPECT_THAT(played.detected, ElementsAre(std::pair("TooSlow", 80030ms)));
}

constexpr const char* kLateRules = R"(
COMPONENT driver NODE /driver LAUNCH "driver"
SIGNAL joint TOPIC /joints FIELD data STALE 1s
RULE DriverFrozen
  POLICIES ERROR
  TRIGGER stddev(joint, 2s) < 0.000001
    STRATEGY driver_redeploy 90 10
      ADAPTATION driver redeploy 25
RULE DriverSlow
  POLICIES ERROR
  TRIGGER rate(/joints) < 9
    STRATEGY driver_replace 90 10
      ADAPTATION driver redeploy 25
)";

// It moves, 20 readings a second.
void drive(TestRobot& robot, Duration time) {
  for (Duration spent{}; spent < time; spent += 50ms) {
    robot.signal("joint", Value(seconds(robot.now.time_since_epoch())), 50ms);
  }
}

TEST(Windows, AHealthyDriverThatComesLateIsLeftAlone) {
  TestRobot robot(kLateRules);
  robot.run_for(15s);
  robot.add("driver", {}, "/joints");
  robot.discover();
  drive(robot, 20s);
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_THAT(robot.asked, IsEmpty());
}

TEST(Windows, AHealthyDriverIsLeftAloneAfterAGapInHearing) {
  TestRobot robot(kLateRules);
  robot.add("driver", {}, "/joints");
  robot.discover();
  drive(robot, 10s);
  for (const Duration gap : {1s, 10s}) {
    robot.freeze(gap);
    robot.tell(Overslept{gap});
    drive(robot, 10s);
  }
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_THAT(robot.asked, IsEmpty());
}

TEST(Windows, AnUncoveredWindowResolvesNothing) {
  TestRobot robot(kLateRules);
  robot.add("driver", {}, "/joints");
  robot.discover();
  for (int i = 0; i < 60; ++i) {
    robot.signal("joint", Value(0.5), 50ms);
  }
  EXPECT_EQ(robot.count("DriverFrozen detected"), 1u);
  robot.run_for(10s);
  EXPECT_EQ(robot.count("DriverFrozen resolved"), 0u);
  drive(robot, 2500ms);
  EXPECT_EQ(robot.count("DriverFrozen resolved"), 1u);
}

TEST(Windows, AValueThatRepeatsItselfIsFrozen) {
  Played played(
      "SIGNAL x TOPIC /x FIELD data\n"
      "RULE Frozen\nPOLICIES WARNING REPORT\nTRIGGER frozen(x, 2s)\n");
  for (int i = 0; i < 100; ++i)
    played.observe(100ms * i, SignalRead{SignalId(0), Value(i < 50 ? 0.1 * i : 4.9)});
  EXPECT_THAT(played.detected, ElementsAre(std::pair("Frozen", 6900ms)));
}

// Nor is one that was received for a shorter time, or that changes.
TEST(Windows, ASilentSignalIsNotFrozen) {
  Played played(
      "SIGNAL x TOPIC /x FIELD data STALE 500ms\n"
      "RULE Frozen\nPOLICIES WARNING REPORT\nTRIGGER frozen(x, 2s)\n");
  for (int i = 0; i < 19; ++i) played.observe(100ms * i, SignalRead{SignalId(0), Value(1.0)});
  for (int i = 0; i < 19; ++i) played.observe(5s + 100ms * i, SignalRead{SignalId(0), Value(1.0)});
  for (int i = 0; i < 60; ++i)
    played.observe(10s + 100ms * i, SignalRead{SignalId(0), Value(i / 10 % 2 == 0 ? 1.0 : 2.0)});
  played.wait_until(30s);
  EXPECT_THAT(played.detected, IsEmpty());
}

TEST(Windows, TheUsageOfAProcessIsThatOfThePresentOne) {
  Played played(
      "COMPONENT c NODE /c\n"
      "RULE Busy\nPOLICIES WARNING REPORT\nTRIGGER cpu(c) > 0.9 && memory(c) > 100\n");
  played.observe(0s, ProcessSeen{ComponentId(0), ProcessState::kRunning, 7, ""},
                 NodeAppeared{"/c", 7}, UsageSeen{ComponentId(0), 0.5, 200});
  played.observe(1s, UsageSeen{ComponentId(0), 1.0, 90});
  EXPECT_THAT(played.detected, IsEmpty());
  played.observe(2s, UsageSeen{ComponentId(0), 1.0, 120});
  EXPECT_THAT(played.detected, ElementsAre(std::pair("Busy", 2s)));
}

TEST(Windows, GoalsCountByHowTheyEndOnceTheWindowIsCovered) {
  Played played(
      "RULE Aborted\nPOLICIES WARNING REPORT\nTRIGGER goals(/go, aborted, 10s) >= 2\n"
      "RULE Slow\nPOLICIES WARNING REPORT\nTRIGGER goal_age(/go) > 5s\n");
  using enum GoalStatus;
  played.observe(0s, NodeAppeared{"/server", 7},
                 EndpointAppeared{"/server", EndpointKind::kPublisher, "/go/_action/status"});
  // Those that were over before culprit listened do not count.
  played.observe(1s, GoalsSeen{TopicId(0), {{1, kAborted}, {2, kAborted}}});
  played.observe(12s, GoalsSeen{TopicId(0), {{1, kAborted}, {2, kAborted}, {3, kExecuting}}});
  played.observe(13s, GoalsSeen{TopicId(0), {{3, kAborted}, {4, kAccepted}}});
  played.observe(20s, GoalsSeen{TopicId(0), {{3, kAborted}, {4, kAborted}}});
  played.observe(21s, GoalsSeen{TopicId(0), {{5, kSucceeded}}});
  played.wait_until(40s);
  EXPECT_THAT(played.detected,
              ElementsAre(std::pair("Slow", 18s + 1ns), std::pair("Aborted", 20s)));
}

TEST(Windows, LinesOfALogCountOnceTheWindowIsCovered) {
  Played played(
      "COMPONENT c NODE /c\n"
      "RULE Errors\nPOLICIES WARNING REPORT\nTRIGGER logs(c, ERROR, 10s) >= 2\n"
      "RULE Quiet\nPOLICIES WARNING REPORT\nTRIGGER logs(c, INFO, 10s) == 0\n");
  const auto line = [](LogLevel level) { return LogSeen{ComponentId(0), level}; };
  played.observe(1s, NodeAppeared{"/c", 7}, line(LogLevel::kError), line(LogLevel::kFatal));
  played.observe(12s, line(LogLevel::kError), line(LogLevel::kWarn), line(LogLevel::kInfo));
  played.wait_until(21s);
  played.observe(21s, line(LogLevel::kFatal));
  played.wait_until(40s);
  EXPECT_THAT(played.detected, ElementsAre(std::pair("Errors", 10s), std::pair("Quiet", 11s),
                                           std::pair("Errors", 21s), std::pair("Quiet", 31s)));
}

TEST(Windows, ALogOfANodeThatWasNeverSeenIsUnknown) {
  Played played(
      "COMPONENT c NODE /c\n"
      "RULE Quiet\nPOLICIES WARNING REPORT\nTRIGGER logs(c, INFO, 10s) == 0\n");
  played.wait_until(30s);
  EXPECT_THAT(played.detected, IsEmpty());
  // It logged nothing before it came.
  played.observe(31s, NodeAppeared{"/c", 7});
  EXPECT_THAT(played.detected, ElementsAre(std::pair("Quiet", 31s)));
}

}  // namespace
}  // namespace culprit::test
