// A component on another computer: culprit as users run it, a real network between two network
// namespaces, and stand-ins for ssh and for the container engine over there.
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "owners/proc.h"
#include "owners/test_engine.h"
#include "owners/test_ssh.h"
#include "ros2/options.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kRemoteRules = R"(
COMPONENT lidar NODE /lidar CONTAINER docker lidar_1 HOST robot@rover2
RULE LidarGone
  POLICIES ERROR
  TRIGGER alive(lidar) == false
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 5
)";

struct NodesOnAnotherComputerOverAStandInForSsh : testing::Test {
  void SetUp() override {
    auto made = TestNetwork::create();
    if (!made) GTEST_SKIP() << made.error();
    network = std::move(*made);
    setenv("ROS_LOCALHOST_ONLY", "0", 1);
    const TestNetwork::Visit visit(*network, TestNetwork::kRobot);
    engine.emplace();
    engine->add("lidar_1", {.policy = "always",
                            .command = {(own_folder() / "ros2_peer_node").string(),
                                        std::to_string(ros2::options_from_environment()->domain),
                                        "--subnet", "/lidar"}});
    engine->start("lidar_1");
  }
  std::unique_ptr<TestProgram> culprit(const std::vector<std::string>& arguments) {
    const TestNetwork::Visit visit(*network, TestNetwork::kDesk);
    return std::make_unique<TestProgram>(world, arguments);
  }
  std::unique_ptr<TestProgram> run() {
    return culprit({"culprit", "run", world.write("remote.rules", kRemoteRules), "--settle", "0.2",
                    "--state-dir", (world.folder() / "state").string()});
  }

  TestWorld world;
  std::unique_ptr<TestNetwork> network;
  owners::TestSsh ssh;
  std::optional<owners::TestEngine> engine;
};

TEST_F(NodesOnAnotherComputerOverAStandInForSsh, ThatHangAreReplacedOnceByTheirOwner) {
  const auto managing = run();
  ASSERT_TRUE(managing->prints("lidar is there")) << managing->output();
  const int old = engine->pid_of("lidar_1");
  kill(old, SIGSTOP);
  EXPECT_TRUE(managing->prints("LidarGone resolved by lidar_redeploy", 60s)) << managing->output();
  EXPECT_THAT(managing->output(), HasSubstr("(docker lidar_1 on robot@rover2)"));
  EXPECT_THAT(engine->asked(), ElementsAre("restart lidar_1"));
  EXPECT_NE(engine->pid_of("lidar_1"), old);
}

TEST_F(NodesOnAnotherComputerOverAStandInForSsh, AreNotDeadWhileThatCannotBeAsked) {
  const auto managing = run();
  ASSERT_TRUE(managing->prints("lidar is there")) << managing->output();
  ssh.refuse("robot@rover2: Permission denied (publickey).");
  ASSERT_TRUE(managing->prints("the state of what it runs is unknown")) << managing->output();
  EXPECT_THAT(managing->output(), HasSubstr("give culprit's user a key"));
  kill(engine->pid_of("lidar_1"), SIGSTOP);
  std::this_thread::sleep_for(4s);  // it does not answer: dead after some 2 s, could it be asked
  EXPECT_THAT(managing->output(), Not(HasSubstr("decided")));
  ssh.allow();
  EXPECT_TRUE(managing->prints("LidarGone resolved by lidar_redeploy", 60s)) << managing->output();
  EXPECT_THAT(engine->asked(), ElementsAre("restart lidar_1"));
}

TEST_F(NodesOnAnotherComputerOverAStandInForSsh, AreReplacedOnceAlsoIfCulpritIsKilledInBetween) {
  auto managing = run();
  ASSERT_TRUE(managing->prints("lidar is there")) << managing->output();
  const int old = engine->pid_of("lidar_1");
  kill(old, SIGSTOP);
  ASSERT_TRUE(managing->prints("redeploy lidar", 60s)) << managing->output();
  for (const Time end = later(live_now(), 30s); engine->asked().empty() && live_now() < end;)
    std::this_thread::sleep_for(5ms);
  managing->signal(SIGKILL);
  managing->wait();
  const auto second = run();
  EXPECT_TRUE(second->prints("lidar is there")) << second->output();
  EXPECT_NE(engine->pid_of("lidar_1"), old);
  EXPECT_THAT(engine->asked(), ElementsAre("restart lidar_1"));
}

TEST_F(NodesOnAnotherComputerOverAStandInForSsh, ThatDoesNotLetUsInAreToldBeforeAnythingBreaks) {
  ssh.refuse("robot@rover2: Permission denied (publickey).");
  auto check = culprit({"culprit", "check", "--robot", world.write("remote.rules", kRemoteRules)});
  EXPECT_EQ(check->wait(), 0);
  EXPECT_THAT(check->output(),
              HasSubstr("[R069]: robot@rover2: Permission denied (publickey); give "
                        "culprit's user a key"));
  EXPECT_THAT(engine->asked(), IsEmpty());
  ssh.be_bare();
  auto other = culprit({"culprit", "check", "--robot", world.write("remote.rules", kRemoteRules)});
  EXPECT_EQ(other->wait(), 0);
  EXPECT_THAT(other->output(), HasSubstr("[R065]: robot@rover2: it has no docker"));
}

}  // namespace
}  // namespace culprit::cli
