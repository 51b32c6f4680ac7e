// Culprit watches a robot over a network that loses, doubles, delays and reorders what is sent, and
// is cut for a while. The robot is on another computer, so culprit can change its nodes' states
// and parameters only, and must not take a cut cable for five dead nodes.
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/test_live_sunset.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

int count_in(const std::string& text, const std::string& what) {
  int count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(Network, ACutCableIsNoReasonToActAndABadOneNoneToFail) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  const TestWorld world;
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  std::optional<lab::LiveSunset> robot;
  {
    const TestNetwork::Visit visit(**network, TestNetwork::kRobot);
    robot.emplace(world);
  }
  const std::string journal = (world.folder() / "sunset.journal").string();
  std::optional<TestProgram> culprit;
  {
    const TestNetwork::Visit visit(**network, TestNetwork::kDesk);
    culprit.emplace(world, std::vector<std::string>{"culprit", "run", "rules/sunset.rules",
                                                    "--journal", journal, "--settle", "2"});
  }
  ASSERT_TRUE(robot->is_well_within(30s)) << robot->complaint();
  for (const char* component : {"camera", "depth", "image_enhancement", "fusion", "segmentation"})
    ASSERT_TRUE(culprit->prints(std::string(component) + " is there")) << culprit->output();

  (*network)->set({.lost = 0.2, .doubled = 0.1, .delay = 10ms});
  ASSERT_TRUE(robot->inject("sync_issue"));
  EXPECT_TRUE(culprit->prints("decided")) << culprit->output();
  EXPECT_TRUE(robot->is_well_within(60s)) << robot->complaint() << "\n" << culprit->output();

  (*network)->set({.is_cut = true});
  EXPECT_TRUE(culprit->prints("HOST DOWN", 60s)) << culprit->output();
  const int decided = count_in(culprit->output(), "decided");  // before it was clear
  std::this_thread::sleep_for(25s);  // until the leases of all nodes ran out
  EXPECT_EQ(count_in(culprit->output(), "decided"), decided) << culprit->output();
  (*network)->set({});
  ASSERT_TRUE(robot->inject("cuda_out_of_memory"));
  EXPECT_TRUE(robot->is_well_within(60s)) << robot->complaint() << "\n" << culprit->output();
  EXPECT_TRUE(culprit->prints("host back")) << culprit->output();

  culprit->signal(SIGINT);
  EXPECT_EQ(culprit->wait(), 0) << culprit->output();
  TestProgram audit(world, {"culprit", "audit", "verify", "--journal", journal});
  EXPECT_EQ(audit.wait(), 0) << audit.output();
  for (const sunset::Member member : sunset::kMembers)
    EXPECT_EQ(robot->processes(member).size(), 1u) << name_of(member);
}

}  // namespace
}  // namespace culprit::cli
