// Success is proven health: when a failure that comes back is the same, and when an outcome counts.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kHealthRules = R"(
CYCLE 100ms
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraSilent
  POLICIES ERROR ATTEMPTS 4
  TRIGGER age(/image) > 300ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 5
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionSilent
  POLICIES ERROR ATTEMPTS 4
  TRIGGER age(/fused) > 300ms
    STRATEGY fusion_restart 50 10
      ADAPTATION fusion restart 5
)";

Manager::Options healthy_after(Duration healthy) {
  Manager::Options options;
  options.governor.limits.backoff.healthy = healthy;
  return options;
}

TestRobot robot_that_is_well(Duration healthy, Intensity restarts = {}) {
  Manager::Options options = healthy_after(healthy);
  options.governor.limits.restarts = restarts;
  TestRobot robot(kHealthRules, std::make_unique<BayesPlanner>(), options);
  robot.add("camera", {}, "/image");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover(6s);
  return robot;
}

Belief belief(TestRobot& robot, const std::string& name) {
  const auto& strategies = robot.rules().strategies;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    if (strategies[s].name == name) return robot.manager().knowledge().beliefs[StrategyId(s)];
  }
  return {};
}

// Breaks the component whenever it has worked for `well`.
void let_crash_again(TestRobot& robot, const std::string& name, Duration well, Duration time) {
  const Time end = robot.now + time;
  Time works_since = robot.now;
  while (robot.now < end) {
    robot.run_for(100ms);
    if (!robot.works(name)) {
      works_since = robot.now;
    } else if (robot.now - works_since >= well) {
      robot[name].fault = "restart";
    }
  }
}

TEST(ProvenHealth, ResolvedIsSaidAtOnceAndLearnedWhenItLasted) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("camera", "restart", 5s);
  EXPECT_EQ(robot.count("CameraSilent resolved by restart"), 1u);
  EXPECT_EQ(belief(robot, "restart"), (Belief{5, 5}));
  robot.run_for(20s);
  EXPECT_EQ(belief(robot, "restart"), (Belief{6, 5}));
}

TEST(ProvenHealth, ACrashLoopIsNoSuccessAndReachesAPerson) {
  TestRobot robot = robot_that_is_well(20s);
  let_crash_again(robot, "camera", 1s, 60s);
  EXPECT_EQ(robot.count("CameraSilent is exhausted"), 1u);
  EXPECT_EQ(robot.count("CameraSilent is flapping"), 1u);
  EXPECT_LE(robot.count_asked("camera: activate") + robot.count_asked("camera: start"), 4u);
  robot.run_for(60s);
  EXPECT_EQ(belief(robot, "restart").alpha, 5);
  EXPECT_EQ(belief(robot, "redeploy").alpha, 9);
  EXPECT_GE(belief(robot, "restart").beta, 6);
}

TEST(ProvenHealth, WhatComesAndGoesByItselfIsOneFailureUntilItStaysAway) {
  TestRobot robot = robot_that_is_well(20s);
  for (int i = 0; i < 10; ++i) {
    robot.fail("camera", "never", 3s);
    robot["camera"].fault = "";
    robot.run_for(3s);
  }
  EXPECT_EQ(robot.count("CameraSilent is exhausted"), 1u);
  EXPECT_EQ(robot.count("CameraSilent is flapping"), 1u);
  // Well for long enough: the next one is another.
  robot.run_for(25s);
  robot.fail("camera", "restart", 5s);
  EXPECT_TRUE(robot.works("camera"));
}

TEST(ProvenHealth, ASecondFaultUpstreamBlamesNobody) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("fusion", "restart", 5s);
  EXPECT_EQ(robot.count("FusionSilent resolved by fusion_restart"), 1u);
  robot.fail("camera", "restart", 60s);
  EXPECT_TRUE(robot.works("fusion"));
  EXPECT_EQ(belief(robot, "fusion_restart"), (Belief{5, 5}));
  EXPECT_EQ(belief(robot, "restart"), (Belief{6, 5}));
}

// The credit must not depend on the outcome.
TEST(ProvenHealth, ASecondFaultUpstreamIsAskedForWhateverCameOut) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("fusion", "a person", 5s);
  EXPECT_GE(robot.count("fusion_restart did not resolve FusionSilent"), 1u);
  robot.fail("camera", "restart", 20s);
  EXPECT_EQ(belief(robot, "restart").beta, 5);
  EXPECT_EQ(belief(robot, "fusion_restart"), (Belief{5, 5}));
}

TEST(ProvenHealth, AFailureIsLearnedAsLateAsASuccess) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("camera", "redeploy", 8s);
  EXPECT_EQ(robot.count("restart did not resolve CameraSilent"), 1u);
  EXPECT_EQ(belief(robot, "restart"), (Belief{5, 5}));
  robot.run_for(25s);
  EXPECT_EQ(belief(robot, "restart"), (Belief{5, 6}));
  EXPECT_EQ(belief(robot, "redeploy").alpha, 10);
}

TEST(ProvenHealth, WhatWaitsForItsProofIsForgottenWithWhatWasLearned) {
  const RuleId camera(0), fusion(1);
  for (const auto& [forgotten, alpha] :
       {std::pair(Forget{fusion}, 6), {Forget{camera}, 5}, {Forget{}, 5}}) {
    TestRobot robot = robot_that_is_well(20s);
    robot.fail("camera", "restart", 5s);
    robot.order({7, "Ann", "", forgotten}, 25s);
    EXPECT_EQ(belief(robot, "restart"), (Belief{static_cast<double>(alpha), 5}));
  }
}

// The next process of culprit, which knows only the events of the one before.
void crash_and_go_on(TestRobot& robot, Duration healthy) {
  Manager::Options options = healthy_after(healthy);
  options.start = robot.now;
  auto manager =
      std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  for (std::size_t s = 0; s < robot.rules().strategies.size(); ++s)
    manager->set_belief(StrategyId(s), robot.manager().knowledge().beliefs[StrategyId(s)]);
  manager->remember(robot.events);
  manager->remember(robot.manager().knowledge().known_robot());
  robot.replace_manager(std::move(manager));
}

TEST(ProvenHealth, WhatWaitedForItsProofStillDoesAfterACrash) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("camera", "restart", 5s);
  crash_and_go_on(robot, 20s);
  robot.run_for(25s);
  EXPECT_EQ(belief(robot, "restart"), (Belief{6, 5}));
  crash_and_go_on(robot, 20s);
  robot.run_for(25s);
  EXPECT_EQ(belief(robot, "restart"), (Belief{6, 5})) << "counted once";
}

// It is unknown whether the repair lasted.
TEST(ProvenHealth, WhatWasNotHeardWhileItWaitedForItsProofCountsAsNothing) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("camera", "restart", 5s);
  robot.tell(HearingLost{"nothing came back"}, 1s);
  robot.tell(HearingRegained{}, 30s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(belief(robot, "restart"), (Belief{5, 5}));
}

TEST(ProvenHealth, ACrashLoopGoesOnBeingOneAcrossCrashesOfCulprit) {
  TestRobot robot = robot_that_is_well(20s);
  for (int i = 0; i < 4; ++i) {
    let_crash_again(robot, "camera", 1s, 4s);
    crash_and_go_on(robot, 20s);
  }
  let_crash_again(robot, "camera", 1s, 20s);
  EXPECT_GE(robot.count("CameraSilent is exhausted"), 1u);
  EXPECT_LE(robot.count_asked("camera: activate") + robot.count_asked("camera: start"), 4u);
}

// Also if few attempts were made, and the next culprit would be allowed more.
TEST(ProvenHealth, WhatIsLeftToAPersonIsSoAcrossCrashesOfCulprit) {
  TestRobot robot = robot_that_is_well(20s, {1, 1h});
  robot.fail("camera", "a person", 30s);
  ASSERT_EQ(robot.count("CameraSilent is exhausted"), 1u);
  ASSERT_EQ(robot.count("camera is held responsible"), 1u);
  crash_and_go_on(robot, 20s);
  robot.run_for(60s);
  EXPECT_EQ(robot.count("camera is held responsible"), 1u);
  EXPECT_EQ(robot.count("CameraSilent is exhausted"), 2u) << "whoever looks now is told too";
}

TEST(ProvenHealth, WhatComesAndGoesIsToldAcrossCrashesOfCulprit) {
  TestRobot robot = robot_that_is_well(20s);
  for (int i = 0; i < Analyzer::kFlaps; ++i) {
    robot.fail("camera", "restart", 4s);
    EXPECT_EQ(robot.count("CameraSilent is flapping"), i + 1 < Analyzer::kFlaps ? 0u : 1u);
    crash_and_go_on(robot, 20s);
    robot.run_for(1s);
  }
}

// A last resort that ended something is not done twice, and the search goes on where it was.
TEST(ProvenHealth, ALastResortIsDoneOnceAcrossACrashOfCulprit) {
  TestRobot robot(std::string(kHealthRules) +
                      "    STRATEGY give_in 50 10 LASTRESORT WITHIN 3s\n"
                      "      ADAPTATION camera stop 50\n",
                  std::make_unique<BayesPlanner>(), healthy_after(20s));
  robot.add("camera", {}, "/image");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover(6s);
  robot["fusion"].fault = "a person";
  const Time end = robot.now + 60s;
  while (robot.count("give_in took effect") == 0 && robot.now < end) robot.run_for(100ms);
  const std::size_t before = robot.count("(fusion_restart, ");
  EXPECT_GE(before, 1u);
  crash_and_go_on(robot, 20s);
  robot.run_for(60s);
  EXPECT_EQ(robot.count("(give_in, "), 1u);
  EXPECT_EQ(robot.count("(fusion_restart, "), 4u) << "ATTEMPTS";
}

TEST(ProvenHealth, WhatIsTriedAnewAfterAPauseIsSoAcrossACrashOfCulprit) {
  TestRobot robot = robot_that_is_well(20s);
  robot["camera"].fault = "a person";
  const Time end = robot.now + 60s;
  while (robot.count("they are tried again after a back-off") == 0 && robot.now < end)
    robot.run_for(100ms);
  const std::size_t before = robot.count("camera is held responsible");
  ASSERT_EQ(before, 2u);
  crash_and_go_on(robot, 20s);
  const Time last = robot.now + 60s;
  while (robot.count("camera is held responsible") == before && robot.now < last)
    robot.run_for(100ms);
  EXPECT_EQ(robot.count("each strategy has been tried lately"), 1u);
  robot.run_for(60s);
  EXPECT_EQ(robot.count("camera is held responsible"), 4u);
}

TEST(ProvenHealth, WhatWasProvenWellAcrossACrashIsNotHeldAgainstTheNextFailure) {
  TestRobot robot = robot_that_is_well(20s);
  robot.fail("camera", "redeploy", 5s);
  ASSERT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
  crash_and_go_on(robot, 20s);
  robot.run_for(30s);
  robot.fail("camera", "redeploy", 5s);
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 2u);
  EXPECT_EQ(robot.count("each strategy has been tried lately"), 0u);
}

// As the paper has it; what its studies are run with.
TEST(ProvenHealth, WithNoneAskedForEachVerdictCountsByItself) {
  TestRobot robot = robot_that_is_well(0s);
  let_crash_again(robot, "camera", 3s, 60s);
  EXPECT_EQ(robot.count("exhausted"), 0u);
  EXPECT_GT(belief(robot, "restart").alpha, 8);
}

}  // namespace
}  // namespace culprit::test
