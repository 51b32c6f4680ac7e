// Processes that do not come up at once: a process that is known to have exited is started again and
// again, and with READY several tries are one start.
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

std::unique_ptr<const Planner> paper_that_starts() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> bayes_that_starts() { return std::make_unique<BayesPlanner>(); }

class Starts : public testing::TestWithParam<PlannerFactory> {
 protected:
  TestRobot driver(const std::string& clauses = "", Manager::Options options = {}) const {
    TestRobot robot("COMPONENT camera NODE /camera LAUNCH \"camera\"" + clauses +
                        "\nCOMPONENT device NODE /device\nRULE Silent\nPOLICIES ERROR ATTEMPTS "
                        "3\nTRIGGER age(/rgb) > 300ms\n"
                        "STRATEGY restart 50 10\nADAPTATION camera restart 5\n"
                        "STRATEGY redeploy 90 10\nADAPTATION camera redeploy 5\n",
                    GetParam()(), options);
    robot.add("device");
    robot.add("camera", {"device"}, "/rgb");
    robot.discover(4s);
    return robot;
  }
};
INSTANTIATE_TEST_SUITE_P(EachPlanner, Starts, testing::Values(paper_that_starts, bayes_that_starts),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

std::size_t starts_of(const TestRobot& robot) { return robot.count_asked("camera: start process"); }

// As Kubernetes does: at most five minutes apart, for ever; a person is notified once.
TEST_P(Starts, OfADeadProcessGoOnForEver) {
  TestRobot robot = driver();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 30min);
  EXPECT_EQ(robot.count("Silent is exhausted"), 1u);
  const std::size_t before = starts_of(robot);
  EXPECT_GE(before, 8u);
  EXPECT_LE(before, 20u);
  robot.run_for(1h);
  EXPECT_GE(starts_of(robot), before + 11);
  EXPECT_LE(starts_of(robot), before + 13);
  EXPECT_EQ(robot.count("Silent is exhausted"), 1u) << "told once";
  robot["camera"].dies_at_start = false;
  robot.run_for(6min);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("Silent resolved by redeploy"), 1u);
}

TEST_P(Starts, BeyondTheBoundOfRestartsAreOnlyDelayed) {
  Manager::Options options;
  options.governor = Governor::Options::recommended();
  options.governor.limits.restarts = {2, 100h};
  TestRobot robot = driver("", options);
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 30min);
  EXPECT_EQ(robot.count("Silent is exhausted"), 1u) << "a person is told";
  EXPECT_GE(starts_of(robot), 6u);
  robot["camera"].dies_at_start = false;
  robot.run_for(11min);
  EXPECT_TRUE(robot.works("camera"));
}

// Its launcher starts it again: a rule that would replace it, too, or its consumer, replaces neither meanwhile.
TEST(AStartByOthers, OfASupplierIsAwaitedByARuleThatReplacesItToo) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE Fused
  POLICIES ERROR
  TRIGGER age(/fused) > 700ms
    STRATEGY fusion_redeploy 80 10
      ADAPTATION fusion redeploy 5
    STRATEGY camera_redeploy 60 10
      ADAPTATION camera redeploy 5
)");
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover(4s);
  robot.kill("camera");
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, 900, ""}, 5s);
  EXPECT_EQ(robot.count("Fused detected"), 1u) << transcript(robot);
  robot.start_by_hand("camera", 10s);
  EXPECT_FALSE(robot.was_asked(" process")) << transcript(robot);
  EXPECT_TRUE(robot.works("fusion"));
}

// It crashes a second after each start.
TEST_P(Starts, OfWhatCrashesAgainAndAgainGetFewer) {
  Manager::Options options;
  options.governor = Governor::Options::recommended();
  TestRobot robot = driver("", options);
  std::size_t after_ten = 0;
  for (int s = 0; s < 3600; ++s) {
    robot.run_for(1s);
    if (robot.works("camera")) robot.kill("camera");
    if (s == 600) after_ten = starts_of(robot);
  }
  EXPECT_EQ(robot.count("Silent is exhausted"), 1u);
  EXPECT_GE(starts_of(robot), after_ten + 8);
  EXPECT_LE(starts_of(robot), after_ten + 12);
}

TEST_P(Starts, TeachNothingOnceTheRuleIsExhausted) {
  TestRobot robot = driver();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 20min);
  const Belief before = robot.manager().knowledge().beliefs[StrategyId(1)];
  robot.run_for(2h);
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(1)], before);
}

// A process that runs and does not work is left to the person.
TEST_P(Starts, OfARunningProcessEndWithItsAttempts) {
  TestRobot robot = driver();
  robot.fail("camera", "a person", 60s);
  ASSERT_EQ(robot.count("Silent is exhausted"), 1u);
  const std::size_t before = robot.asked.size();
  robot.run_for(1h);
  EXPECT_EQ(robot.asked.size(), before);
  robot["camera"].fault.clear();
  robot["camera"].start_time = 1s;
  robot.kill("camera", 20s);
  EXPECT_TRUE(robot.works("camera")) << "now it is down, and started";
}

// A device that can be opened again only after 20 s.
TEST_P(Starts, WithinReadyAreTriesOfOneAttempt) {
  TestRobot robot = driver(" READY 30s");
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 20s);
  robot["camera"].dies_at_start = false;
  robot.run_for(16s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  EXPECT_EQ(robot.count("(redeploy, "), 1u) << "one attempt";
  EXPECT_EQ(starts_of(robot), 6u) << "after 1, 2, 4, 8 and 16 s";
}

TEST_P(Starts, WithoutReadyAreAttempts) {
  TestRobot robot = driver();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 3s);
  EXPECT_GE(robot.count("redeploy did not resolve Silent: camera: it exited at once"), 1u);
}

TEST_P(Starts, FailWhenReadyIsOver) {
  TestRobot robot = driver(" READY 10s");
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 9s);
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  robot.run_for(3s);
  EXPECT_EQ(robot.count("redeploy did not resolve Silent: camera: it exited at once"), 1u);
}

// Its node is there for a moment before the device refuses it.
TEST_P(Starts, ThatEndWhenTheNodeWasThereAreTriesToo) {
  TestRobot robot = driver(" READY 30s");
  robot["device"].fault = "a person";
  robot.kill("camera");
  for (int i = 0; i < 100; ++i) {
    robot.run_for(100ms);
    if (robot["camera"].is_in_graph && i % 7 == 6) robot.kill("camera");
  }
  EXPECT_EQ(robot.count("did not resolve"), 0u);
  EXPECT_GE(starts_of(robot), 3u);
  robot["device"].fault.clear();
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("(redeploy, "), 1u);
}

}  // namespace
}  // namespace culprit::test
