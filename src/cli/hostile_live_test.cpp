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
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_attacks.h"
#include "exemplars/sunset/node_process.h"
#include "ros2/options.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kHostileRules = R"(
ROBOT attacked
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/managed_subsystem/rgb_camera) > 5s
    STRATEGY camera_replace 90 10
      ADAPTATION camera redeploy 5
RULE CameraOff
  POLICIES ERROR
  TRIGGER lifecycle(camera) == "inactive" || lifecycle(camera) == "finalized"
    STRATEGY camera_again 90 10
      ADAPTATION camera redeploy 5
RULE CameraSick
  POLICIES ERROR
  TRIGGER level(camera) >= 2 || parameter(camera, image_degradation) > 0.5
    STRATEGY camera_anew 90 10
      ADAPTATION camera redeploy 5
)";
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

std::size_t times(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

template <class Done>
bool within(Duration patience, Done done) {
  for (const Time end = later(live_now(), patience); !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

class Hostile : public testing::TestWithParam<Attack> {
 protected:
  ~Hostile() override {
    for (const int pid : cameras()) kill(pid, SIGKILL);
  }

  std::vector<int> cameras() const {
    return sunset::processes_of(sunset::Member::kCamera, ros2::options_from_environment()->domain);
  }
  TestProgram start_culprit() const {
    // So much is never broken in so short a time but here.
    return TestProgram(world, {"culprit",
                               "run",
                               world.write("attacked.rules", kHostileRules),
                               "--settle",
                               "1",
                               "--state-dir",
                               (world.folder() / "state").string(),
                               "--web",
                               "--port",
                               "0",
                               "--intensity",
                               "none",
                               "--intensity-kind",
                               "none",
                               "--intensity-component",
                               "none",
                               "--restarts",
                               "none",
                               "--backoff",
                               "0",
                               "--healthy",
                               "1"});
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
                           times(said, " detected") != times(before, " detected") ||
                           times(said, "resolved by") != times(before, "resolved by");
    harmed += is_harmed ? 1 : 0;
    EXPECT_FALSE(is_harmed) << said.substr(before.size());
  }
  void expect_healed(const TestProgram& culprit) {
    const std::string before = culprit.output();
    for (const int pid : cameras()) kill(pid, SIGKILL);
    const Time broken = live_now();
    const bool is_healed = within(std::max(kHealedWithin, Duration(TestProgram::kPatience)), [&] {
      return times(culprit.output(), "resolved by") > times(before, "resolved by");
    });
    const Duration took = live_now() - broken;
    longest = std::max(longest, took);
    EXPECT_TRUE(is_healed) << culprit.output();
    EXPECT_EQ(cameras().size(), 1u) << "resolved, and it is not there";
    if (hostile_tries() > 0) {
      EXPECT_LE(took, kHealedWithin) << culprit.output().substr(before.size());
    }
  }

  TestWorld world;
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
  const TestProgram culprit = start_culprit();
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  Target target{world, culprit.pid(), 0, page_of(culprit), nullptr};
  if (is_elsewhere) {
    at.reset();
    at.emplace(*network, TestNetwork::kDesk);
  }
  ros2::Eavesdropper eavesdropper(*ros2::options_from_environment());
  target.eavesdropper = &eavesdropper;
  expect_healed(culprit);  // with all that it needs for that
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
    expect_healed(culprit);
    EXPECT_LE(holdings_of(culprit.pid()).kilobytes, at_first + kMostGrowth);
    EXPECT_THAT(culprit.output(), Not(HasSubstr("\x1b"))) << "it steers the terminal";
  }
  std::cout << "hostile | " << GetParam().name << " | " << tried << " | " << harmed << " | "
            << seconds(longest) << "\n";
}

INSTANTIATE_TEST_SUITE_P(All, Hostile, testing::ValuesIn(tried_attacks()),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace culprit::cli
