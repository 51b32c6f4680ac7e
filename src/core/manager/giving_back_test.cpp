// A component that a strategy left inactive is activated again, also if no failure asks for it any more: while it is
// inactive its own rule may be blind.
#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr ComponentId kBlurredCamera(0);

template <class What>
void give_order(TestRobot& robot, What what) {
  robot.order(Order{7, "Ann", "", std::move(what)});
}

// The camera reports its blur while it is active.
void live_with_blur(TestRobot& robot, Duration time) {
  for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms)) {
    if (robot["camera"].state == Lifecycle::kActive)
      robot.signal("blur", Value(robot["camera"].fault.empty() ? 0.0 : 1.0));
  }
}

bool has_active_camera(TestRobot& robot) { return robot["camera"].state == Lifecycle::kActive; }

// A pause interrupts a restart after the camera was deactivated, and lasts until its rule is blind.
TestRobot paused_in_restart(const std::string& more_rules = "") {
  TestRobot robot(R"(
INTERLOCK speed < 0.1
SIGNAL blur DIAGNOSTIC camera KEY blur STALE 3s
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0
    STRATEGY restart 90 10
      ADAPTATION camera restart 2
)" + more_rules);
  robot.add("camera");
  robot.discover();
  robot.signal("speed", Value(0.0));
  live_with_blur(robot, 3s);
  robot["camera"].fault = "restart";
  robot.signal("blur", Value(1.0));
  for (int ms = 0; ms < 2000 && !robot.was_asked("camera: deactivate"); ++ms) robot.run_for(1ms);
  EXPECT_TRUE(robot.was_asked("camera: deactivate"));
  give_order(robot, Pause{});
  live_with_blur(robot, 40s);
  EXPECT_FALSE(has_active_camera(robot)) << "nothing is undone while it is paused";
  EXPECT_TRUE(std::ranges::any_of(robot.events, [](const Event& event) {
    return std::holds_alternative<FailureLost>(event.what);
  }));
  return robot;
}

TEST(GivingBack, ActivatesAfterAPauseWhatAnInterruptedRestartLeftInactive) {
  TestRobot robot = paused_in_restart();
  give_order(robot, Resume{});
  live_with_blur(robot, 5s);
  EXPECT_TRUE(has_active_camera(robot));
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
  EXPECT_EQ(robot.count_asked("camera: deactivate"), 1u);
  EXPECT_FALSE(robot.manager().knowledge().components[kBlurredCamera].is_to_be_given_back());
}

TEST(GivingBack, IsUpToTheNextCulprit) {
  TestRobot robot = paused_in_restart();
  Manager::Options options;
  options.start = robot.now;
  auto next = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(robot.events);
  robot.replace_manager(std::move(next));
  robot.signal("speed", Value(0.0));
  live_with_blur(robot, 20s);
  EXPECT_TRUE(has_active_camera(robot));
}

TEST(GivingBack, WaitsForAnInterlock) {
  TestRobot robot = paused_in_restart();
  robot.signal("speed", Value(1.0));
  give_order(robot, Resume{});
  live_with_blur(robot, 20s);
  EXPECT_FALSE(has_active_camera(robot));
  robot.signal("speed", Value(0.0));
  live_with_blur(robot, 5s);
  EXPECT_TRUE(has_active_camera(robot));
}

TEST(GivingBack, LeavesAMutedComponentAlone) {
  TestRobot robot = paused_in_restart();
  give_order(robot, Silence{kBlurredCamera, 60s});
  give_order(robot, Resume{});
  live_with_blur(robot, 30s);
  EXPECT_FALSE(has_active_camera(robot));
}

// A person, or another program, has changed it since: that stands.
TEST(GivingBack, LeavesAloneWhatSomethingElseHasChanged) {
  TestRobot robot = paused_in_restart();
  for (const Lifecycle state :
       {Lifecycle::kActive, Lifecycle::kUnconfigured, Lifecycle::kInactive}) {
    robot["camera"].state = state;
    robot.tell(LifecycleRead{kBlurredCamera, state}, 100ms);
  }
  give_order(robot, Resume{});
  live_with_blur(robot, 30s);
  EXPECT_FALSE(has_active_camera(robot));
}

// The camera is too hot during the pause. It is not switched on again when it has cooled down.
TEST(GivingBack, LeavesInactiveWhatALastResortWantsInactive) {
  TestRobot robot = paused_in_restart(R"(
RULE Hot
  POLICIES ERROR
  TRIGGER heat > 90
    STRATEGY off 100 10 LASTRESORT
      ADAPTATION camera deactivate 1
)");
  robot.signal("heat", Value(95.0), 1s);
  give_order(robot, Resume{});
  live_with_blur(robot, 5s);
  EXPECT_EQ(robot.count("off took effect"), 1u);
  robot.signal("heat", Value(20.0));
  live_with_blur(robot, 30s);
  EXPECT_FALSE(has_active_camera(robot));
}

// It was deactivated while its driver is replaced, and the driver is dead. The next culprit does not see that at once.
TEST(GivingBack, LeavesInactiveWhatCommandsADeadDriver) {
  TestRobot robot(R"(
COMPONENT planner NODE /planner LAUNCH "planner"
COMPONENT driver NODE /driver LAUNCH "driver"
RULE Silent
  POLICIES ERROR ATTEMPTS 50
  TRIGGER age(/joints) > 500ms
    STRATEGY in_steps 80 10
      ADAPTATION planner deactivate 2
      THEN ADAPTATION driver redeploy 10
      THEN ADAPTATION planner activate 2
)");
  robot.add("planner");
  robot.add("driver", {}, "/joints");
  robot.discover(7s);
  robot["driver"].dies_at_start = true;
  robot.kill("driver", 10s);
  ASSERT_EQ(robot["planner"].state, Lifecycle::kInactive);
  Manager::Options options;
  options.start = robot.now;
  auto next = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(robot.events);
  next->remember(robot.manager().knowledge().known_robot());
  robot.replace_manager(std::move(next));
  robot.run_for(60s);
  EXPECT_FALSE(robot.was_asked("planner: activate"));
}

TEST(GivingBack, IsTriedMoreAndMoreRarely) {
  TestRobot robot = paused_in_restart();
  robot["camera"].refuses = true;
  give_order(robot, Resume{});
  live_with_blur(robot, 70s);
  EXPECT_GE(robot.count_asked("camera: activate"), 2u);
  EXPECT_LE(robot.count_asked("camera: activate"), 4u);
  robot["camera"].refuses = false;
  live_with_blur(robot, 90s);
  EXPECT_TRUE(has_active_camera(robot));
}

}  // namespace
}  // namespace culprit::test
