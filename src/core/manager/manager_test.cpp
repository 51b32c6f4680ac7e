#include "manager/manager.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "manager/test_pipeline.h"
#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

std::unique_ptr<const Planner> paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> bayes() { return std::make_unique<BayesPlanner>(); }
std::unique_ptr<const Planner> without_dependencies() {
  return std::make_unique<PaperPlanner>(PaperSwitches{.dependencies = false});
}

// Behaviour that holds with every planner.
class ManagerWith : public testing::TestWithParam<PlannerFactory> {
 protected:
  TestRobot pipeline(Autonomy autonomy = Autonomy::kAct) const {
    return test::pipeline(GetParam()(), autonomy);
  }
};
INSTANTIATE_TEST_SUITE_P(EachPlanner, ManagerWith, testing::Values(paper, bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

TEST_P(ManagerWith, RestartsTheRootCauseAndNothingElse) {
  TestRobot robot = pipeline();
  robot.fail("camera", "restart", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("detected"), 3u);
  EXPECT_EQ(robot.count("CameraDead resolved by restart"), 1u);
  EXPECT_EQ(robot.count("FusionDead cleared without a repair of its own"), 1u);
  EXPECT_FALSE(robot.was_asked("fusion:"));
  EXPECT_FALSE(robot.was_asked("segmentation:"));
  EXPECT_EQ(robot.count_asked("camera: deactivate"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
}

TEST(Manager, BlamesEveryComponentWithoutTheDependencyGraph) {
  TestRobot robot = pipeline(without_dependencies());
  robot.fail("camera", "restart", 10s);
  EXPECT_TRUE(robot.was_asked("fusion:"));
  EXPECT_TRUE(robot.was_asked("segmentation:"));
}

// An answer to one command must not be taken for one to another.
TEST_P(ManagerWith, NumbersItsCommandsUpwards) {
  TestRobot robot = pipeline();
  std::vector<std::uint64_t> numbers;
  robot.before_commands = [&](std::vector<Observation>&, std::span<const Command> commands) {
    for (const Command& command : commands) numbers.push_back(command.id.number);
    return true;
  };
  robot.fail("camera", "redeploy", 20s);
  EXPECT_GE(numbers.size(), 4u);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>()));
}

// No message from this robot wakes the manager any more.
TEST(Manager, WakesByItselfToTryAnewAfterAPause) {
  TestRobot robot(
      "COMPONENT camera NODE /camera\n"
      "RULE Blurred\n  POLICIES ERROR ATTEMPTS 4\n  TRIGGER blur > 1\n"
      "    STRATEGY refocus 60 10\n      ADAPTATION camera set_parameter focus 1 5\n");
  robot.add("camera");
  robot.discover(6s);
  robot.signal("blur", Value(2.0), 120s);
  EXPECT_GE(robot.count("camera is held responsible"), 2u);
}

// Its clock is not ours: a time in the future counts as now.
TEST_P(ManagerWith, IsNotCarriedIntoTheFutureByAnObservation) {
  TestRobot robot = pipeline();
  const Observation early{robot.now + 1h, NodeAppeared{"/somebody", 0}};
  EXPECT_TRUE(robot.manager().step(robot.now, {&early, 1}).empty());
  robot.run_for(2s);
  EXPECT_EQ(robot.count("detected"), 0u);
}

TEST_P(ManagerWith, RedeploysWhenARestartDidNotHelp) {
  TestRobot robot = pipeline();
  robot.fail("fusion", "redeploy", 8s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("restart did not resolve FusionDead"), 1u);
  EXPECT_EQ(robot.count("FusionDead resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count("fusion is lost: culprit ended it"), 1u);
  EXPECT_EQ(robot.count_asked("fusion: start process"), 1u);
  EXPECT_FALSE(robot.was_asked("segmentation:"));
}

TEST_P(ManagerWith, RedeploysADeadProcessAtOnce) {
  TestRobot robot = pipeline();
  robot.kill("camera", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("camera: deactivate")) << "a dead process cannot restart its node";
  EXPECT_EQ(robot.count("camera is lost: killed by signal 9"), 1u);
}

TEST_P(ManagerWith, RedeploysAStoppedProcess) {
  TestRobot robot = pipeline();
  robot.stop("segmentation", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count_asked("segmentation: stop process"), 1u);
}

TEST_P(ManagerWith, HealsAHungNodeThatAnswersNothing) {
  TestRobot robot = pipeline();
  robot["fusion"].answers = false;
  robot.fail("fusion", "redeploy", 12s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("restart fusion: failed, it did not answer"), 1u);
}

TEST_P(ManagerWith, KnowsConsumersOfADeadNodeEvenWhenItLeftTheGraph) {
  TestRobot robot = pipeline();
  robot["camera"].start_time = 3s;
  robot.kill("camera", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

TEST_P(ManagerWith, HealsTwoDeadNodesAtOnce) {
  TestRobot robot = pipeline();
  robot.kill("camera");
  robot.kill("segmentation", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

TEST_P(ManagerWith, SaysWhatItWouldDoAndDoesNothingInADryRun) {
  TestRobot robot = pipeline(Autonomy::kAdvise);
  robot.fail("camera", "restart", 10s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("camera is held responsible for CameraDead and FusionDead and"), 0u);
  EXPECT_EQ(robot.count("would restart camera"), 1u);
}

TEST_P(ManagerWith, GivesUpAfterItsAttempts) {
  TestRobot robot = pipeline();
  robot["camera"].fault = "a person";
  robot.fail("fusion", "restart", 200s);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 3u);
  EXPECT_FALSE(robot.was_asked("fusion:")) << "it waits for a person with the camera";
  const std::size_t asked = robot.count_asked("camera:");
  robot.run_for(100s);
  EXPECT_EQ(robot.count_asked("camera:"), asked) << "nothing is tried after exhaustion";
  robot["camera"].fault.clear();
  robot.run_for(2s);
  EXPECT_EQ(robot.count("CameraDead cleared"), 1u) << "an exhausted failure that heals is reported";
}

TEST_P(ManagerWith, LearnsFromVerdicts) {
  TestRobot robot = pipeline();
  const Belief restart = robot.manager().knowledge().beliefs[StrategyId(2)];
  const Belief redeploy = robot.manager().knowledge().beliefs[StrategyId(3)];
  robot.fail("fusion", "redeploy", 8s);
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(2)],
            (Belief{restart.alpha, restart.beta + 1}));
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(3)],
            (Belief{redeploy.alpha + 1, redeploy.beta}));
}

TEST(Manager, LearnsNothingFromOutcomesWithTwoCauses) {
  TestRobot robot = pipeline(without_dependencies());
  const Belief before = robot.manager().knowledge().beliefs[StrategyId(4)];
  robot["camera"].fault = "restart";  // all three are restarted; only the camera's restart helps
  robot.run_for(10s);
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(4)], before);
}

TEST_P(ManagerWith, TreatsARestartWhoseRepliesAreLostAsDone) {
  TestRobot robot = pipeline();
  robot["camera"].fault = "restart";
  robot["camera"].loses_replies = true;
  robot.run_for(20s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count_asked("camera: deactivate"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
  EXPECT_FALSE(robot.was_asked("camera: start process"));
}

TEST_P(ManagerWith, BringsARelaunchedLifecycleNodeBackToWhereItWas) {
  TestRobot robot = pipeline();
  robot["camera"].state_at_start = Lifecycle::kUnconfigured;
  robot.kill("camera", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count_asked("camera: configure"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
}

TEST_P(ManagerWith, ReportsAComponentThatDiesAtEveryStart) {
  TestRobot robot = pipeline();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 120s);
  EXPECT_GE(robot.count("it exited at once: exit code 1"), 2u);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
}

TEST(Health, OneRulesRecoveryDoesNotWipeAnothers) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
RULE CameraDead
  POLICIES ERROR
  TRIGGER dead > 0
    STRATEGY s 50 10
      ADAPTATION camera set_parameter p 1 100
RULE Focus
  POLICIES NON_CRITICAL
  TRIGGER blur > 0
    STRATEGY s 50 10
      ADAPTATION camera set_parameter q 1 1
RULE FusionDead
  POLICIES ERROR
  TRIGGER silent > 0
    STRATEGY s 50 10
      ADAPTATION fusion set_parameter p 1 1
)");
  robot.add("camera").parameters = {{"p", Value(std::int64_t{0})}, {"q", Value(std::int64_t{0})}};
  robot.add("fusion", {"camera"}).parameters["p"] = Value(std::int64_t{0});
  robot.discover();
  for (const char* x : {"dead", "blur", "silent"}) robot.signal(x, Value(0.0));
  robot.signal("blur", Value(1.0));
  robot.signal("dead", Value(1.0), 100ms);
  robot.signal("blur", Value(0.0), 1s);
  EXPECT_EQ(robot.count("Focus cleared"), 1u);
  robot.signal("silent", Value(1.0), 2s);
  EXPECT_FALSE(robot.was_asked("fusion:")) << "the camera is still sick";
  EXPECT_EQ(
      robot.count("FusionDead waits: it depends on camera, which may be the cause (CameraDead)"),
      1u);
}

}  // namespace
}  // namespace culprit::test
