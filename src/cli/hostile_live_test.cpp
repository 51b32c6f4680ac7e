// Each attack of test_attacks.h on a culprit whose robot is healthy, and then has a real fault while the attack goes on.
//
// culprit ends no healthy process, reports no failure and no recovery that is none, heals the fault, and does not grow.
//
// CULPRIT_HOSTILE_TRIES says how often each attack is tried (scripts/hostile). Without it, a few of them are tried once,
// and how fast the fault is healed does not count.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "cli/test_attacked_robot.h"
#include "cli/test_attacks.h"
#include "ros2/options.h"
#include "ros2/test_forger.h"
#include "rtps/test_network.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr Duration kHealedWithin = 10s;
constexpr std::size_t kMostGrowth = 64 * 1024;  // KiB

int hostile_tries() { return std::atoi(environment("CULPRIT_HOSTILE_TRIES").c_str()); }

std::vector<Attack> tried_attacks() {
  std::vector<Attack> all;
  for (const auto& some : {attacks_by_datagrams(), attacks_by_participants(),
                           attacks_on_this_computer(), attacks_on_the_page()})
    std::ranges::copy_if(some, std::back_inserter(all), [](const Attack& attack) {
      return hostile_tries() > 0 || attack.is_in_short;
    });
  return all;
}

class Hostile : public AttackedRobot, public testing::WithParamInterface<Attack> {
 protected:
  TestProgram start_hostile_culprit() const {
    // So much is never broken in so short a time but here.
    return start_culprit({"--web", "--port", "0", "--intensity", "none", "--intensity-kind", "none",
                          "--intensity-component", "none", "--restarts", "none", "--backoff", "0",
                          "--healthy", "1"});
  }
  static int page_of(const TestProgram& culprit) {
    const std::string said = "http://127.0.0.1:";
    if (!culprit.prints(said)) return 0;
    return std::atoi(culprit.output().c_str() + culprit.output().find(said) + said.size());
  }
  // The healthy robot is left alone.
  void expect_no_harm(const TestProgram& culprit, const std::vector<int>& camera,
                      const std::string& before, const TestProgram& bystander) {
    const std::string said = culprit.output();
    const bool is_harmed = cameras() != camera || kill(bystander.pid(), 0) != 0 ||
                           count_of(said, " detected") != count_of(before, " detected") ||
                           count_of(said, "resolved by") != count_of(before, "resolved by");
    harmed += is_harmed ? 1 : 0;
    EXPECT_FALSE(is_harmed) << said.substr(before.size());
  }
  void expect_healed_soon(const TestProgram& culprit) {
    const Duration took = expect_healed(culprit);
    longest = std::max(longest, took);
    if (hostile_tries() > 0) {
      EXPECT_LE(took, kHealedWithin) << culprit.output();
    }
  }

  int harmed = 0;
  Duration longest{};
};

TEST_P(Hostile, NeitherHarmsTheRobotNorKeepsItFromHealing) {
  const bool is_elsewhere = GetParam().from == Place::kElsewhere;
  std::unique_ptr<TestNetwork> network;
  std::optional<TestNetwork::Visit> at;
  if (is_elsewhere) {
    auto made = TestNetwork::create();
    if (!made) GTEST_SKIP() << made.error();
    network = std::move(*made);
    setenv("ROS_LOCALHOST_ONLY", "0", 1);
    at.emplace(*network, TestNetwork::kRobot);
  }
  const TestProgram bystander(world, {"sunset-node", "world"});
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram culprit = start_hostile_culprit();
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  // Attacks on the ports of its look would reach nobody.
  ASSERT_TRUE(has_looked(culprit)) << culprit.output();
  Target target{world, culprit.pid(), 0, page_of(culprit), nullptr};
  if (is_elsewhere) {
    at.reset();
    at.emplace(*network, TestNetwork::kDesk);
  }
  ros2::Eavesdropper eavesdropper(*ros2::options_from_environment());
  target.eavesdropper = &eavesdropper;
  expect_healed_soon(culprit);  // with all that it needs for that
  const std::size_t at_first = holdings_of(culprit.pid()).kilobytes;
  const int tries = std::max(1, hostile_tries());
  int tried = 0;
  for (; tried < tries && !HasFailure(); ++tried) {
    const std::vector<int> healthy = cameras();
    ASSERT_EQ(healthy.size(), 1u) << culprit.output();
    target.camera = healthy.front();
    const std::string before = culprit.output();
    const Ongoing attack = GetParam().begin(target);
    if (attack == nullptr) GTEST_SKIP() << "not possible here";
    std::this_thread::sleep_for(4s);
    expect_no_harm(culprit, healthy, before, bystander);
    expect_healed_soon(culprit);
    EXPECT_LE(holdings_of(culprit.pid()).kilobytes, at_first + kMostGrowth);
    EXPECT_TRUE(culprit.prints(GetParam().reported)) << culprit.output();
    EXPECT_THAT(culprit.output(), Not(HasSubstr("\x1b"))) << "it steers the terminal";
  }
  std::cout << "hostile | " << GetParam().name << " | " << tried << " | " << harmed << " | "
            << seconds(longest) << "\n";
}

INSTANTIATE_TEST_SUITE_P(All, Hostile, testing::ValuesIn(tried_attacks()),
                         [](const auto& each) { return std::string(each.param.name); });

// A stranger on another computer holds the node's name, and announces a port of a process here.
TEST_F(AttackedRobot, StrangerOnAnotherComputerDoesNotChooseWhichProcessEnds) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  std::optional<TestNetwork::Visit> here(std::in_place, **network, TestNetwork::kRobot);
  const ros2::Bound port = ros2::bound();
  TestProgram victim(world, {"sleep", "600"});  // inherits it
  close(port.descriptor);
  const TestProgram run = start_culprit({"--quiet", "0", "--no-evidence"}, R"(
ROBOT attacked
COMPONENT camera NODE /camera LAUNCH "sleep 600"
RULE CameraThere
  POLICIES ERROR
  TRIGGER alive(camera)
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
)");
  ASSERT_TRUE(run.prints("watching attacked")) << run.output();
  here.reset();
  here.emplace(**network, TestNetwork::kDesk);
  ros2::Forger stranger(*ros2::options_from_environment(), port.port, "10.77.0.2");
  stranger.says_that_it_holds({"/", "camera", {}, {}});
  EXPECT_TRUE(run.prints("its process is not known; is it on another machine?")) << run.output();
  std::this_thread::sleep_for(3s);
  EXPECT_FALSE(victim.wait(0s)) << "it was ended: " << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("redeploy camera: done")));
}

}  // namespace
}  // namespace culprit::cli
