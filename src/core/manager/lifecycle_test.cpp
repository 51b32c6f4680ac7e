// The driver that takes a node through its lifecycle when its process begins, and the time that it
// gets for that.
#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

// `clause` of the component; the redeploy takes ten cycles of 200 ms.
std::string camera_with(const std::string& clause) {
  return "COMPONENT camera NODE /camera LAUNCH \"camera\" " + clause +
         "\nRULE Dead\n  POLICIES ERROR\n  TRIGGER age(/rgb) > 350ms\n"
         "    STRATEGY redeploy 90 10\n      ADAPTATION camera redeploy 10\n";
}

// It comes up unconfigured.
TestRobot robot_of(const std::string& rules, Duration activates_itself_after = {},
                   Duration quiet_downstream = {}, Duration seen_for = 2s) {
  Manager::Options options;
  options.governor.limits.quiet_downstream = quiet_downstream;
  TestRobot robot(rules, std::make_unique<BayesPlanner>(), options);
  auto& added = robot.add("camera", {}, "/rgb");
  added.state_at_start = Lifecycle::kUnconfigured;
  added.activates_itself_after = activates_itself_after;
  robot.discover(seen_for);
  return robot;
}

// Somebody else does.
void change_state(TestRobot& robot, Lifecycle state) {
  robot["camera"].state = state;
  robot.tell(LifecycleRead{ComponentId(0), state});
}

// It works again so long after it was killed.
void expect_recovery(TestRobot& robot, Duration time) {
  robot.kill("camera", time);
  EXPECT_TRUE(robot.works("camera"));
}

// It is killed that often, and each time one start is enough.
void expect_one_start_each(TestRobot& robot, std::size_t kills) {
  for (std::size_t starts = 1; starts <= kills; ++starts) {
    expect_recovery(robot, 60s);
    EXPECT_EQ(robot.count_asked("camera: start"), starts);
  }
}

TEST(Lifecycles, WhatActivatesItselfByDeclarationIsNeverToldTo) {
  TestRobot robot = robot_of(camera_with("LIFECYCLE self"), 6s);
  expect_recovery(robot, 20s);
  EXPECT_EQ(robot.count_asked("camera: start"), 1u);
  EXPECT_FALSE(robot.was_asked("camera: configure"));
}

TEST(Lifecycles, ADeclaredDriverThatNeverComesIsAFailureThatSaysSo) {
  TestRobot robot = robot_of(camera_with("LIFECYCLE launcher"));
  robot.kill("camera", 40s);
  EXPECT_FALSE(robot.was_asked("camera: configure"));
  EXPECT_GE(robot.count("its driver did not bring it up (LIFECYCLE)"), 1u);
}

TEST(Lifecycles, AManagedNodeIsNotWaitedFor) {
  TestRobot robot = robot_of(camera_with("LIFECYCLE managed"));
  expect_recovery(robot, 1500ms);
}

// Its driver is unknown: culprit activates it after the impact, and its own timer then fails.
TEST(Lifecycles, ANodeThatActivatesItselfCrashesOnceAtMost) {
  TestRobot robot = robot_of(camera_with(""), 4s);
  expect_recovery(robot, 60s);
  EXPECT_EQ(robot.count_asked("camera: start"), 2u);
  for (int again = 0; again < 2; ++again) expect_recovery(robot, 60s);
  EXPECT_EQ(robot.count_asked("camera: start"), 4u);
  EXPECT_EQ(robot.count_asked("camera: configure"), 1u);
}

std::string active_camera_with(const std::string& clause) {
  return camera_with(clause) +
         "RULE Idle\n  POLICIES WARNING\n  TRIGGER lifecycle(camera) != \"active\"\n"
         "    STRATEGY activate 90 10\n      ADAPTATION camera activate 5\n";
}

// Its driver was not seen, for culprit came later.
TEST(Lifecycles, ANodeThatActivatesItselfWithinTheImpactNeverCrashes) {
  TestRobot robot = robot_of(camera_with(""), 1500ms);
  expect_one_start_each(robot, 3);
  EXPECT_FALSE(robot.was_asked("camera: configure"));
  EXPECT_FALSE(robot.was_asked("camera: activate"));
}

// A rule says that it must be active: culprit brings it there at once, until it knows better.
TEST(Lifecycles, ANodeThatARuleWantsActiveCrashesOnceAtMostToo) {
  TestRobot robot = robot_of(active_camera_with(""), 4s);
  for (int kills = 1; kills <= 3; ++kills) expect_recovery(robot, 60s);
  EXPECT_EQ(robot.count_asked("camera: start"), 4u);
  EXPECT_EQ(robot.count_asked("camera: configure"), 1u);
}

TEST(Lifecycles, ANodeThatStartsSlowlyIsGivenAsLongAgain) {
  TestRobot robot = robot_of(camera_with(""), 5s);
  robot["camera"].start_time = 6s;
  expect_recovery(robot, 60s);
  EXPECT_EQ(robot.count_asked("camera: start"), 1u);
  EXPECT_FALSE(robot.was_asked("camera: configure"));
}

// It is there after 300 ms.
TEST(Lifecycles, ANodeThatNobodyDrivesIsActivatedWhenTheImpactIsOver) {
  TestRobot robot = robot_of(camera_with(""));
  robot.kill("camera");
  while (!robot.was_asked("camera: start") && robot.now < Time(10s)) robot.run_for(10ms);
  const Time started = robot.now;
  while (!robot.was_asked("camera: configure") && robot.now < Time(20s)) robot.run_for(10ms);
  EXPECT_GE(robot.now - started, 1900ms);
  EXPECT_LE(robot.now - started, 2200ms);
  robot.run_for(1s);
  EXPECT_TRUE(robot.works("camera"));
  const Time killed = robot.now;
  robot.kill("camera");
  while (!robot.works("camera") && robot.now < killed + 10s) robot.run_for(100ms);
  EXPECT_LT(robot.now - killed, 1500ms) << "that culprit does it is known by now";
}

// It comes between the two requests of culprit, and does not mind.
TEST(Lifecycles, ADriverThatShowsUpLateIsLeftAlone) {
  TestRobot robot = robot_of(camera_with(""));
  robot.kill("camera");
  while (!robot.was_asked("camera: start") && robot.now < Time(10s)) robot.run_for(10ms);
  robot.run_for(1s);
  ASSERT_FALSE(robot.was_asked("camera: configure"));
  change_state(robot, Lifecycle::kInactive);
  robot.run_for(3s);
  EXPECT_FALSE(robot.was_asked("camera: activate")) << "whoever configured it goes on";
  change_state(robot, Lifecycle::kActive);
  robot.run_for(5s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_FALSE(robot.was_asked("camera: activate"));
  EXPECT_EQ(robot.manager().knowledge().components[ComponentId(0)].coming_up.driver,
            ComingUp::Driver::kOther);
}

// Its timer finds it configured, or active.
TEST(Lifecycles, WhatIsWronglyDeclaredManagedIsToldWithWhatToDeclare) {
  for (const Duration after : {12ms, 400ms}) {
    TestRobot robot = robot_of(camera_with("LIFECYCLE managed"), after);
    robot.kill("camera", 5s);
    EXPECT_GE(robot.count("does it activate itself? Then it is LIFECYCLE self"), 1u);
  }
}

// As a node in Python does: how its process exits is seen after culprit has ended it.
TEST(Lifecycles, ANodeThatLeavesTheGraphBeforeItsProcessEndsCrashesOnceAtMostToo) {
  TestRobot robot = robot_of(camera_with(""), 4s);
  robot["camera"].leaves_before_it_ends = true;
  expect_recovery(robot, 60s);
  EXPECT_EQ(robot.count_asked("camera: start"), 2u);
  EXPECT_EQ(robot.count_asked("camera: configure"), 1u);
}

TEST(Lifecycles, ANodeThatWasSeenToActivateItselfIsWaitedFor) {
  TestRobot robot(camera_with(""));
  auto& added = robot.add("camera", {}, "/rgb");
  added.state = added.state_at_start = Lifecycle::kUnconfigured;
  added.activates_itself_after = 3s;
  robot.discover(2900ms);
  change_state(robot, Lifecycle::kActive);
  robot.run_for(5s);
  expect_recovery(robot, 30s);
  EXPECT_EQ(robot.count_asked("camera: start"), 1u);
  EXPECT_FALSE(robot.was_asked("camera: configure"));
}

TEST(Lifecycles, AnObservedDriverThatDoesNotComeAgainIsReplaced) {
  TestRobot robot = robot_of(camera_with(""), 1s);
  robot.kill("camera", 10s);
  ASSERT_TRUE(robot.works("camera"));
  robot["camera"].activates_itself_after = {};
  expect_recovery(robot, 15s);
  EXPECT_TRUE(robot.was_asked("camera: activate"));
  const Time killed = robot.now;
  robot.kill("camera");
  while (!robot.works("camera") && robot.now < killed + 10s) robot.run_for(100ms);
  EXPECT_LT(robot.now - killed, 1500ms) << "that culprit does it is known by now";
}

TEST(Lifecycles, ARuleThatItMustBeActiveOutweighsThatOthersDeactivatedIt) {
  TestRobot robot =
      robot_of(camera_with("LIFECYCLE managed") +
               "RULE Idle\n  POLICIES WARNING FOR 30s\n  TRIGGER lifecycle(camera) != \"active\"\n"
               "    STRATEGY activate 90 10\n      ADAPTATION camera activate 5\n");
  change_state(robot, Lifecycle::kInactive);
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_TRUE(robot.was_asked("camera: start"));
}

TEST(Lifecycles, WhatARestartReachedIsWhatIsIntended) {
  TestRobot robot = robot_of(
      "COMPONENT camera NODE /camera LAUNCH \"camera\" LIFECYCLE managed\nRULE Dead\n"
      "  POLICIES ERROR\n  TRIGGER age(/rgb) > 350ms\n    STRATEGY restart 90 10\n"
      "      ADAPTATION camera restart 5\n    STRATEGY redeploy 60 10\n"
      "      ADAPTATION camera redeploy 10\n");
  change_state(robot, Lifecycle::kInactive);
  robot.run_for(10s);
  ASSERT_TRUE(robot.works("camera"));
  expect_recovery(robot, 10s);
}

TEST(Lifecycles, AnErrorInOnActivateEndsTheAttemptAtOnce) {
  TestRobot robot = robot_of(
      "COMPONENT camera NODE /camera LAUNCH \"camera\" LIFECYCLE managed\nRULE Dead\n"
      "  POLICIES ERROR\n  TRIGGER age(/rgb) > 350ms\n    STRATEGY activate 90 10\n"
      "      ADAPTATION camera activate 5\n");
  robot["camera"].fails_to_activate = true;
  change_state(robot, Lifecycle::kInactive);
  robot.run_for(1500ms);
  EXPECT_GE(robot.count("it fell back to unconfigured when asked to activate"), 1u);
  EXPECT_GE(robot.count("camera: inactive again"), 1u);
}

TEST(Lifecycles, AGoalEndsWithItsProcess) {
  TestRobot robot = robot_of(camera_with("LIFECYCLE self"));
  robot.kill("camera", 3s);
  ASSERT_EQ(robot.count_asked("camera: start"), 1u);
  robot.kill("camera");
  EXPECT_GE(robot.count("it is not there any more: killed by signal 9"), 1u);
}

TEST(Lifecycles, AStartIsWaitedForWhileItsProcessRuns) {
  TestRobot robot = robot_of(camera_with("LIFECYCLE managed"));
  robot["camera"].start_time = 45s;
  expect_one_start_each(robot, 2);
}

// ---- of a live robot, where nodes have to find each other (Knowledge::finding)

TestRobot live_robot_of(const std::string& rules, Duration activates_itself_after = {}) {
  return robot_of(rules, activates_itself_after, 3500ms, 6s);
}

TEST(LiveLifecycles, ANodeThatActivatesItselfIsWatchedFirstAndNeverCrashes) {
  for (const std::string& rules : {camera_with(""), active_camera_with("")}) {
    TestRobot robot = live_robot_of(rules, 4s);
    expect_one_start_each(robot, 3);
    EXPECT_FALSE(robot.was_asked("camera: activate"));
  }
}

TEST(LiveLifecycles, ANodeThatNobodyDrivesIsActivatedAfterTheWatchAndAtOnceTheNextTime) {
  TestRobot robot = live_robot_of(active_camera_with(""));
  expect_recovery(robot, 12s);
  robot.run_for(60s);
  expect_recovery(robot, 3s);
}

// Meanwhile one rule sees it unconfigured, and another one misses its topic.
TEST(LiveLifecycles, ANodeThatActivatedItselfBeforeIsLeftToThatAlsoWhenAPersonStartsIt) {
  TestRobot robot = live_robot_of(active_camera_with(""), 4s);
  robot.kill("camera", 60s);
  robot.kill("camera");
  robot.start_by_hand("camera", 20s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_FALSE(robot.was_asked("camera: configure"));
  EXPECT_EQ(robot.count_asked("camera: start"), 1u);
}

TEST(LiveLifecycles, ANodeThatAnswersLateWhileItLoadsIsAskedAgain) {
  TestRobot robot = live_robot_of(camera_with("LIFECYCLE managed"));
  robot["camera"].answers_after_start = 6s;
  expect_recovery(robot, 20s);
  EXPECT_EQ(robot.count_asked("camera: start"), 1u);
  EXPECT_EQ(robot.count("failed"), 0u);
}

}  // namespace
}  // namespace culprit::test
