// culprit asks the owner of a component, and never works against it: nodes that a real systemd
// runs, and culprit as users run it.
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "owners/proc.h"
#include "owners/test_engine.h"
#include "owners/test_systemd.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kOwnerRules = R"(
COMPONENT lidar NODE /lidar UNIT lidar.service USER
RULE LidarGone
  POLICIES ERROR
  TRIGGER alive(lidar) == false
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 5
)";

struct NodesOfARealSystemd : testing::Test {
  void SetUp() override {
    systemd = owners::UserSystemd::begin();
    if (!systemd) GTEST_SKIP() << "this machine lets nobody run an instance of systemd";
  }
  void start(const std::string& settings) { start(node(), settings); }
  void start(const std::string& command, const std::string& settings) {
    systemd->start("lidar.service", command, settings);
  }
  std::string node() const {
    return (own_folder() / "ros2_peer_node").string() + " " +
           std::to_string(ros2::options_from_environment()->domain) + " /lidar";
  }
  TestProgram run() {
    return TestProgram(
        world, {"culprit", "run", world.write("units.rules", kOwnerRules), "--settle", "0.2",
                "--state-dir", (world.folder() / "state").string()});
  }
  // Waits until another process than `old` is there; 0: none came.
  static int another(const TestProgram& culprit, int old) {
    for (const Time end = later(live_now(), TestProgram::kPatience); live_now() < end;) {
      const int now = pid_in(culprit.output(), "lidar");
      if (now != 0 && now != old) return now;
      std::this_thread::sleep_for(20ms);
    }
    return 0;
  }
  // The failed component works again, under the same owner and started once.
  void expect_healed(const TestProgram& culprit, int old) {
    EXPECT_TRUE(culprit.prints("LidarGone resolved by lidar_redeploy")) << culprit.output();
    const int now = another(culprit, old);
    ASSERT_NE(now, 0) << culprit.output();
    EXPECT_EQ(owners::state_letter(old).value_or('Z'), 'Z');
    owners::SystemdBus bus(owners::SystemdBus::Whose::kUser);
    const auto is_its = bus.runs("lidar.service", now);
    EXPECT_TRUE(is_its && *is_its) << now << " is not of the unit";
    EXPECT_EQ(systemd->starts_of("lidar.service"), 2);
    EXPECT_THAT(culprit.output(), Not(HasSubstr("several nodes")));
  }

  TestWorld world;
  std::unique_ptr<owners::UserSystemd> systemd;
};

TEST_F(NodesOfARealSystemd, ThatAreKilledAreStartedOnce) {
  start("");
  const auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  kill(old, SIGKILL);
  expect_healed(culprit, old);
}

TEST_F(NodesOfARealSystemd, ThatItStartsAgainItselfAreNotDoubled) {
  start("Restart=always\nRestartSec=3\n");  // culprit decides before that
  const auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  kill(old, SIGKILL);
  expect_healed(culprit, old);
}

TEST_F(NodesOfARealSystemd, ThatHangAreReplaced) {
  start("Restart=always\n");
  const auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  kill(old, SIGSTOP);
  expect_healed(culprit, old);
}

TEST_F(NodesOfARealSystemd, ThatFailedBeforeAnybodyLookedAreStarted) {
  const std::string can = (systemd->folder() / "can").string();
  start("/bin/sh -c 'test -e " + can + " && exec " + node() + "'", "");
  owners::SystemdBus bus(owners::SystemdBus::Whose::kUser);
  for (const Time end = later(live_now(), TestProgram::kPatience); live_now() < end;) {
    const auto state = bus.state_of("lidar.service");
    ASSERT_TRUE(state) << state.error();
    if (state->activity == owners::UnitState::Activity::kFailed) break;
    std::this_thread::sleep_for(20ms);
  }
  std::ofstream(can) << "now";
  const auto culprit = run();
  EXPECT_TRUE(culprit.prints("lidar.service failed: exit-code")) << culprit.output();
  EXPECT_NE(another(culprit, 0), 0) << culprit.output();
  EXPECT_EQ(systemd->starts_of("lidar.service"), 2);
}

TEST_F(NodesOfARealSystemd, ThatItStartsNoMoreAreLeftToItWithTheReason) {
  start("[Unit]\nStartLimitBurst=1\nStartLimitIntervalSec=1000\n");
  const auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  kill(old, SIGKILL);
  EXPECT_TRUE(culprit.prints("systemd could not start it: lidar.service failed"))
      << culprit.output();
  EXPECT_EQ(systemd->starts_of("lidar.service"), 1);
}

TEST_F(NodesOfARealSystemd, ThatHaveALaunchInTheRulesAreToldToBeUnits) {
  start("");
  const auto rules =
      world.write("launch.rules", "COMPONENT lidar NODE /lidar LAUNCH \"" + node() + "\"\n");
  const TestProgram culprit(
      world, {"culprit", "run", rules, "--state-dir", (world.folder() / "state").string()});
  EXPECT_TRUE(
      culprit.prints("systemd runs it as lidar.service, and may start it beside culprit: "
                     "declare UNIT lidar.service USER instead"))
      << culprit.output();
}

// For systemd the unit failed, and the kernel reports a crash before anybody knows of the order.
TEST_F(NodesOfARealSystemd, ThatSystemctlStopsStayDownThoughTheyCrashOnIt) {
  start("ExecStop=/bin/kill -SEGV $MAINPID\n");
  const auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  std::this_thread::sleep_for(2s);  // culprit has seen that its unit runs
  owners::SystemdBus bus(owners::SystemdBus::Whose::kUser);
  ASSERT_TRUE(bus.stop("lidar.service", 0s));
  EXPECT_TRUE(culprit.prints("lidar stays down: its owner ended it")) << culprit.output();
  const auto state = bus.state_of("lidar.service");
  ASSERT_TRUE(state) << state.error();
  EXPECT_EQ(state->activity, owners::UnitState::Activity::kFailed);
  std::this_thread::sleep_for(3s);  // that nothing happens takes time
  EXPECT_EQ(systemd->starts_of("lidar.service"), 1) << culprit.output();
  TestProgram revive(world, {"culprit", "revive"});
  revive.wait();
  EXPECT_NE(another(culprit, old), 0) << culprit.output();
}

// systemd was asked for both, the end and the start.
TEST_F(NodesOfARealSystemd, ComeBackAlsoIfCulpritIsKilledInBetween) {
  start("");
  auto culprit = run();
  const int old = another(culprit, 0);
  ASSERT_NE(old, 0) << culprit.output();
  kill(old, SIGSTOP);
  ASSERT_TRUE(culprit.prints("redeploy lidar")) << culprit.output();
  culprit.signal(SIGKILL);
  culprit.wait();
  const auto second = run();
  EXPECT_NE(another(second, old), 0) << second.output();
  EXPECT_EQ(systemd->starts_of("lidar.service"), 2);
}

TEST_F(NodesOfARealSystemd, ThatItHasNotAreToldBeforeAnythingBreaks) {
  start("");
  const auto rules =
      world.write("typo.rules", "COMPONENT lidar NODE /lidar UNIT lydar.service USER\n");
  TestProgram check(world, {"culprit", "check", "--robot", rules});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(check.output(),
              HasSubstr("the user's systemd has no lydar.service; did you mean lidar.service?"));
}

// An upgrade of the engine with live-restore: its containers run on, and it does not answer.
TEST(NodesOfAStandInForDocker, AreLeftAloneWhileTheEngineIsAway) {
  const TestWorld world;
  owners::TestEngine engine;
  engine.add("lidar_1",
             {.command = {(own_folder() / "ros2_peer_node").string(),
                          std::to_string(ros2::options_from_environment()->domain), "/lidar"}});
  const int first = engine.start("lidar_1");
  const auto rules = world.write(
      "container.rules",
      "COMPONENT lidar NODE /lidar CONTAINER docker lidar_1\nRULE LidarGone\n  POLICIES ERROR\n"
      "  TRIGGER alive(lidar) == false\n    STRATEGY lidar_redeploy 90 10\n"
      "      ADAPTATION lidar redeploy 5\n");
  const TestProgram culprit(world, {"culprit", "run", rules, "--settle", "0.2", "--state-dir",
                                    (world.folder() / "state").string()});
  ASSERT_TRUE(culprit.prints("lidar is there (process " + std::to_string(first) + ")"))
      << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  engine.hang(true);
  std::this_thread::sleep_for(6s);  // that nothing happens takes time
  EXPECT_THAT(culprit.output(), Not(HasSubstr("lidar is lost")));
  // One that crashes meanwhile waits for the engine, and no attempt is spent.
  kill(first, SIGKILL);
  EXPECT_TRUE(culprit.prints("lidar cannot be started: docker: it does not answer"))
      << culprit.output();
  std::this_thread::sleep_for(6s);
  EXPECT_THAT(culprit.output(), Not(HasSubstr("exhausted")));
  EXPECT_THAT(engine.asked(), testing::IsEmpty());
  engine.hang(false);
  EXPECT_TRUE(culprit.prints("LidarGone resolved by lidar_redeploy")) << culprit.output();
  EXPECT_THAT(engine.asked(), testing::ElementsAre("start lidar_1"));
}

// The engine is a stand-in that speaks the Docker Engine API.
TEST(NodesOfAStandInForDocker, ThatHangOrAreKilledAreStartedOnceByIt) {
  const TestWorld world;
  owners::TestEngine engine;
  engine.add("lidar_1",
             {.policy = "always",
              .command = {(own_folder() / "ros2_peer_node").string(),
                          std::to_string(ros2::options_from_environment()->domain), "/lidar"}});
  const int first = engine.start("lidar_1");
  const auto rules = world.write(
      "container.rules",
      "COMPONENT lidar NODE /lidar CONTAINER docker lidar_1\nRULE LidarGone\n  POLICIES ERROR\n"
      "  TRIGGER alive(lidar) == false\n    STRATEGY lidar_redeploy 90 10\n"
      "      ADAPTATION lidar redeploy 5\n");
  const TestProgram culprit(world, {"culprit", "run", rules, "--settle", "0.2", "--state-dir",
                                    (world.folder() / "state").string()});
  ASSERT_TRUE(culprit.prints("lidar is there (process " + std::to_string(first) + ")"))
      << culprit.output();
  kill(first, SIGSTOP);
  EXPECT_TRUE(culprit.prints("LidarGone resolved by lidar_redeploy")) << culprit.output();
  EXPECT_THAT(engine.asked(), testing::ElementsAre("restart lidar_1"));
  const int second = engine.pid_of("lidar_1");
  EXPECT_TRUE(culprit.prints("lidar is there (process " + std::to_string(second) + ")"))
      << culprit.output();
  kill(second, SIGKILL);  // the engine starts it again by itself
  EXPECT_TRUE(culprit.prints("lidar is lost")) << culprit.output();
  for (const Time end = later(live_now(), TestProgram::kPatience);
       live_now() < end && engine.pid_of("lidar_1") == second;)
    std::this_thread::sleep_for(20ms);
  EXPECT_TRUE(
      culprit.prints("lidar is there (process " + std::to_string(engine.pid_of("lidar_1")) + ")"))
      << culprit.output();
  EXPECT_THAT(engine.asked(), testing::ElementsAre("restart lidar_1"));
  EXPECT_THAT(culprit.output(), Not(HasSubstr("several nodes")));
}

}  // namespace
}  // namespace culprit::cli
