// Strategies in steps (THEN): components that are taken down for a repair, and when they come up
// again.
#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::test {
namespace {

// A planner that commands a driver: no topic shows that it must not run without it.
std::string arm_with(const std::string& adaptations, const std::string& policies = "") {
  return "COMPONENT planner NODE /planner LAUNCH \"planner\"\n"
         "COMPONENT driver NODE /driver LAUNCH \"driver\"\n"
         "COMPONENT light NODE /light LAUNCH \"light\"\n"
         "RULE Silent\n  POLICIES ERROR " +
         policies +
         "\n  TRIGGER age(/joints) > 500ms\n"
         "    STRATEGY in_steps 80 10\n" +
         adaptations;
}

constexpr const char* kAround =
    "      ADAPTATION planner deactivate 2\n"
    "      THEN ADAPTATION driver redeploy 10\n"
    "      THEN ADAPTATION planner activate 2\n";
constexpr const char* kStopped =
    "      ADAPTATION planner stop 2\n"
    "      THEN ADAPTATION driver redeploy 10\n"
    "      THEN ADAPTATION planner start 10\n";

TestRobot arm_robot(const std::string& rules) {
  TestRobot robot(rules);
  robot.add("planner");
  robot.add("driver", {}, "/joints");
  robot.add("light");
  robot.discover(7s);
  return robot;
}

std::size_t place_of(const TestRobot& robot, const std::string& request) {
  const auto found = std::ranges::find_if(
      robot.asked, [&](const std::string& line) { return line.starts_with(request); });
  return static_cast<std::size_t>(found - robot.asked.begin());
}

TEST(Steps, EachBeginsWhenTheOneBeforeIsProven) {
  TestRobot robot = arm_robot(arm_with(kAround));
  robot["driver"].fault = "redeploy";
  robot["driver"].start_time = 2s;
  bool was_there_first = true;
  robot.after_step = [&] {
    const auto& driver = robot["driver"];
    const bool is_up = driver.is_in_graph && driver.process == ProcessState::kRunning;
    if (!is_up && robot.was_asked("planner: activate")) was_there_first = false;
  };
  robot.run_for(20s);
  EXPECT_TRUE(was_there_first);
  EXPECT_LT(place_of(robot, "planner: deactivate"), place_of(robot, "driver: stop"));
  EXPECT_LT(place_of(robot, "driver: start"), place_of(robot, "planner: activate"));
  EXPECT_TRUE(robot.works("planner"));
  EXPECT_EQ(robot.count("Silent resolved by in_steps"), 1u);
  EXPECT_EQ(robot.count("deactivate planner, then redeploy driver, then activate planner"), 1u);
}

TEST(Steps, NothingIsActivatedThatWasNotActive) {
  TestRobot robot = arm_robot(arm_with(kAround));
  robot["planner"].state = Lifecycle::kInactive;
  robot.tell(LifecycleRead{robot.id("planner"), Lifecycle::kInactive});
  robot.fail("driver", "redeploy", 20s);
  EXPECT_EQ(robot.count("Silent resolved by in_steps"), 1u);
  EXPECT_FALSE(robot.was_asked("planner: activate"));
  EXPECT_EQ(robot["planner"].state, Lifecycle::kInactive);
}

// culprit was killed when the driver was back: the next one gives back what that one had taken.
TEST(Steps, AreFinishedByTheNextCulprit) {
  TestRobot robot = arm_robot(arm_with(kAround));
  robot["planner"].state = Lifecycle::kInactive;
  const Command taken{{7},
                      robot.id("planner"),
                      ChangeLifecycle{Transition::kDeactivate},
                      1s,
                      Purpose{StrategyId(0), 0, false, Lifecycle::kActive}};
  Manager::Options options;
  options.start = robot.now;
  auto next = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(robot.manager().knowledge().known_robot());
  next->resume({StrategyId(0), 2, false, {{taken, Outcome::kDone}}});
  robot.replace_manager(std::move(next));
  robot.run_for(20s);
  EXPECT_TRUE(robot.was_asked("planner: activate"));
  EXPECT_EQ(robot["planner"].state, Lifecycle::kActive);
}

// culprit was killed between two tries: the next one knows from the journal what the first try owes.
TEST(Steps, WhatATryOwesIsGivenBackByTheNextCulprit) {
  TestRobot robot = arm_robot(arm_with(kAround, "ATTEMPTS 50"));
  robot["driver"].dies_at_start = true;
  robot.kill("driver", 10s);
  ASSERT_EQ(robot["planner"].state, Lifecycle::kInactive);
  ASSERT_FALSE(robot.was_asked("planner: activate"));
  robot["driver"].dies_at_start = false;
  robot["driver"].fault = "nothing helps";
  robot.start_by_hand("driver");
  Manager::Options options;
  options.start = robot.now;
  auto next = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(robot.events);
  next->remember(robot.manager().knowledge().known_robot());
  robot.replace_manager(std::move(next));
  robot.run_for(120s);
  EXPECT_TRUE(robot.was_asked("planner: activate"));
}

// A process that is dead is deactivated enough.
TEST(Steps, TheDriverIsReplacedBehindADeadPlanner) {
  TestRobot robot = arm_robot(arm_with(kAround));
  robot.kill("planner", 5s);
  robot.fail("driver", "redeploy", 20s);
  EXPECT_EQ(robot.count("Silent resolved by in_steps"), 1u);
  EXPECT_FALSE(robot.was_asked("planner: deactivate"));
  EXPECT_FALSE(robot.was_asked("planner: activate"));
}

TEST(Steps, UndoingLeavesWhatAPersonHasChangedSince) {
  TestRobot robot =
      arm_robot(arm_with("      ADAPTATION light deactivate 2\n"
                         "      THEN ADAPTATION driver set_parameter gain 2.0 20\n",
                         "ATTEMPTS 1"));
  robot["driver"].parameters = {{"gain", Value(1.0)}};
  robot["driver"].fault = "nothing helps";
  for (int i = 0; i < 100 && robot["light"].state == Lifecycle::kActive; ++i) robot.run_for(100ms);
  ASSERT_EQ(robot["light"].state, Lifecycle::kInactive);
  for (const Lifecycle wish : {Lifecycle::kActive, Lifecycle::kInactive}) {
    robot.run_for(500ms);
    robot["light"].state = wish;
    robot.tell(LifecycleRead{robot.id("light"), wish});
  }
  robot.run_for(20s);
  EXPECT_EQ(robot["light"].state, Lifecycle::kInactive);
  EXPECT_EQ(robot.count("light: active: something else has changed it since"), 1u);
}

TEST(Steps, UndoingDoesNotActivateWhatCommandsADeadDriver) {
  TestRobot robot = arm_robot(arm_with(kAround, "ATTEMPTS 1"));
  robot["driver"].dies_at_start = true;
  robot.kill("driver", 40s);
  EXPECT_FALSE(robot.was_asked("planner: activate"));
  EXPECT_EQ(robot["planner"].state, Lifecycle::kInactive);
  EXPECT_GE(robot.count("cannot be undone: planner: active: it may depend on driver"), 1u);
  EXPECT_GE(robot.count("Silent is exhausted"), 1u);
}

// Two lines without THEN say as much: the driver is redeployed behind a planner that is inactive.
TEST(Steps, NorDoesUndoingAStrategyWithoutSteps) {
  TestRobot robot =
      arm_robot(arm_with("      ADAPTATION planner deactivate 2\n"
                         "      ADAPTATION driver redeploy 10\n",
                         "ATTEMPTS 1"));
  robot["driver"].dies_at_start = true;
  robot.kill("driver", 40s);
  EXPECT_FALSE(robot.was_asked("planner: activate"));
}

TEST(Steps, UndoingGoesBackwardsWhereAllIsUp) {
  TestRobot robot =
      arm_robot(arm_with("      ADAPTATION planner deactivate 2\n"
                         "      THEN ADAPTATION driver redeploy 10\n"
                         "      THEN ADAPTATION light set_parameter red true 2\n"
                         "      THEN ADAPTATION planner activate 2\n",
                         "ATTEMPTS 1"));
  robot["light"].refuses = true;
  robot.fail("driver", "nothing helps", 40s);
  EXPECT_EQ(robot["planner"].state, Lifecycle::kActive);
  EXPECT_EQ(robot.count("planner: active again"), 1u);
}

TEST(Steps, WhatIsStoppedForARepairIsStartedAgainInUndoing) {
  TestRobot robot =
      arm_robot(arm_with("      ADAPTATION planner stop 2\n"
                         "      THEN ADAPTATION light set_parameter red true 2\n"
                         "      THEN ADAPTATION planner start 10\n",
                         "ATTEMPTS 1"));
  robot["light"].refuses = true;
  robot.fail("driver", "nothing helps", 40s);
  EXPECT_TRUE(robot.works("planner"));
  EXPECT_EQ(robot.count_asked("planner: start"), 1u);
}

TEST(Steps, WhatIsStoppedStaysStoppedWhileTheDriverIsDown) {
  TestRobot robot = arm_robot(arm_with(kStopped, "ATTEMPTS 1"));
  robot["driver"].dies_at_start = true;
  robot.kill("driver", 40s);
  EXPECT_FALSE(robot.was_asked("planner: start"));
  EXPECT_EQ(robot["planner"].process, ProcessState::kGone);
}

// The first try has left the planner inactive, or stopped: that step is done already.
TEST(Steps, TheNextTryGoesOnFromWhatTheFirstOneLeft) {
  for (const char* steps : {kAround, kStopped}) {
    TestRobot robot = arm_robot(arm_with(steps));
    robot["driver"].dies_at_start = true;
    robot.kill("driver", 10s);
    ASSERT_FALSE(robot.works("driver"));
    robot["driver"].dies_at_start = false;
    robot.run_for(120s);
    EXPECT_TRUE(robot.works("driver"));
    EXPECT_TRUE(robot.works("planner"));
  }
}

TEST(Steps, TheImpactIsTheSumOfTheirs) {
  const RuleSet rules = arm_robot(arm_with("      ADAPTATION planner deactivate 2\n"
                                           "      ADAPTATION light restart 5\n"
                                           "      THEN ADAPTATION driver redeploy 10\n"))
                            .rules();
  EXPECT_EQ(rules.strategies[0].impact.count, 15);
}

}  // namespace
}  // namespace culprit::test
