// The lifecycle manager of the tests gets stuck as Nav2's does.
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/peer_process.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::Not;

struct Servers {
  std::unique_ptr<PeerProcess> start(const std::string& name) const {
    return std::make_unique<PeerProcess>(
        std::vector<std::string>{CULPRIT_PEER_NODE, std::to_string(domain.number()), name});
  }
  std::unique_ptr<PeerProcess> start_manager() const {
    return std::make_unique<PeerProcess>(
        std::vector<std::string>{CULPRIT_PEER_MANAGER, std::to_string(domain.number()), "/manager",
                                 "/controller", "/planner", "/navigator"});
  }

  TestDomain domain;
  std::unique_ptr<PeerProcess> controller = start("/controller");
  std::unique_ptr<PeerProcess> planner = start("/planner");
  std::unique_ptr<PeerProcess> navigator = start("/navigator");
};

TEST(PeerManager, IsBlockedByAServerThatHangs) {
  Servers servers;
  const auto manager = servers.start_manager();
  ASSERT_TRUE(manager->says("Managed nodes are active"));
  kill(servers.planner->pid(), SIGSTOP);
  ASSERT_TRUE(manager->says("Deactivating /planner"));
  std::this_thread::sleep_for(3s);
  EXPECT_THAT(manager->lines().all(), Contains("Deactivating /navigator"));
  EXPECT_THAT(manager->lines().all(), Not(Contains("Deactivating /controller")));
}

TEST(PeerManager, StartsAllAgainIfAServerWasReplacedInTime) {
  Servers servers;
  const auto manager = servers.start_manager();
  ASSERT_TRUE(manager->says("Managed nodes are active"));
  servers.planner->end(SIGKILL);
  servers.planner = servers.start("/planner");
  ASSERT_TRUE(manager->says("Cleaning up /controller"));
  EXPECT_TRUE(manager->lines().wait_for_count(6 + 1 + 6 + 6 + 1));
  EXPECT_EQ(manager->lines().all().back(), "Managed nodes are active");
}

TEST(PeerManager, CannotStartServersThatAreActive) {
  Servers servers;
  auto manager = servers.start_manager();
  ASSERT_TRUE(manager->says("Managed nodes are active"));
  manager->end(SIGKILL);
  manager = servers.start_manager();
  EXPECT_TRUE(manager->says("Failed to bring up all requested nodes. Aborting bringup."));
}

}  // namespace
}  // namespace culprit::ros2
