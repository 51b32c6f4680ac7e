// Our own nodes in processes of their own: a manager's observations and actions across processes,
// and when they are killed.
#include <algorithm>
#include <memory>
#include <signal.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/live_test.h"
#include "ros2/node.h"
#include "ros2/peer_process.h"
#include "ros2/process_finder.h"
#include "ros2/services.h"
#include "ros2/test_change_state.h"

namespace culprit::ros2 {
namespace {

std::unique_ptr<PeerProcess> start_node(const TestDomain& domain, const std::string& name) {
  return std::make_unique<PeerProcess>(
      std::vector<std::string>{CULPRIT_PEER_NODE, std::to_string(domain.number()), name});
}

Graph::Options with_processes() {
  Graph::Options options;
  options.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  options.is_running = [](int pid) { return kill(pid, 0) == 0; };
  return options;
}

struct PeersManager {
  explicit PeersManager(const TestDomain& domain)
      : context(domain.options(), with_processes()), node(*context, {"/", "manager"}) {}

  std::unique_ptr<ServiceClient> changes_state_of(const std::string& robot) {
    return std::move(*ServiceClient::create(
        node, {robot + "/change_state", std::string(srv::ChangeState::kType)}, rtps::qos::kServices,
        {{robot + "/get_state", std::string(srv::GetState::kType)},
         rtps::encode(srv::GetState::Request{})}));
  }

  LiveContext context;
  NodeEntry node;
};

TEST(PeerNode, IsSeenWithItsProcess) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto peer = start_node(domain, "/ns/peer");
  EXPECT_TRUE(manager.context.sees_process("/ns/peer", peer->pid()));
}

// As one whose computer was cut off: its lease runs out, and it has announced everything before.
TEST(PeerNode, IsSeenAgainWhenItComesBackAfterItsLeaseRanOut) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto peer = start_node(domain, "/peer");
  ASSERT_TRUE(manager.context.sees_process("/peer", peer->pid()));
  kill(peer->pid(), SIGSTOP);
  const auto sees = [&](auto is_it, int times) {
    const Time end = later(live_now(), std::chrono::minutes(1));  // its lease is 20 s
    while (live_now() < end) {
      const auto changes = manager.context.changes().all();
      if (std::ranges::count_if(changes, is_it) >= times) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  };
  ASSERT_TRUE(sees(
      [](const GraphChange& change) {
        const auto* left = std::get_if<NodeLeft>(&change);
        return left != nullptr && left->node == "/peer" && left->was_lost;
      },
      1));
  kill(peer->pid(), SIGCONT);
  EXPECT_TRUE(sees(
      [](const GraphChange& change) {
        const auto* joined = std::get_if<NodeJoined>(&change);
        return joined != nullptr && joined->node.name == "/peer";
      },
      2));
  EXPECT_TRUE(change(*manager.changes_state_of("/peer"), 1)) << "and it is as it was";
}

TEST(PeerNode, IsSteeredAcrossProcesses) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto peer = start_node(domain, "/peer");
  const auto client = manager.changes_state_of("/peer");
  for (const std::uint8_t id : {1, 3, 4, 2}) EXPECT_TRUE(change(*client, id)) << int{id};
}

TEST(PeerNode, SaysGoodByeWhenItIsTerminated) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto peer = start_node(domain, "/peer");
  ASSERT_TRUE(manager.context.sees_node("/peer"));
  const int status = peer->end(SIGTERM);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_TRUE(manager.context.sees_node_leave("/peer"));
}

TEST(PeerNode, IsReplacedWhenItIsKilledAndStartedAgain) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto client = manager.changes_state_of("/peer");
  for (int i = 0; i < 3; ++i) {
    const auto peer = start_node(domain, "/peer");
    ASSERT_TRUE(manager.context.sees_process("/peer", peer->pid()));
    EXPECT_TRUE(change(*client,
                       1));  // at once to the new one, though the leases of the dead ones still run
    peer->end(SIGKILL);
  }
  for (const GraphChange& change : manager.context.changes().all()) {
    const auto* trouble = std::get_if<GraphTrouble>(&change);
    EXPECT_EQ(trouble, nullptr) << trouble->text;
  }
}

TEST(PeerNode, LeavesAtOnceWhenItsProcessIsKnownToHaveEnded) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto client = manager.changes_state_of("/peer");
  const auto peer = start_node(domain, "/peer");
  const int pid = peer->pid();
  ASSERT_TRUE(manager.context.sees_process("/peer", pid));
  ASSERT_TRUE(change(*client, 1));
  peer->end(SIGKILL);
  manager.context->forget_process(pid);
  ASSERT_TRUE(manager.context.sees_node_leave("/peer"));
  EXPECT_FALSE(client->is_ready());  // so nothing is sent to the dead
  const auto successor = start_node(domain, "/peer");
  EXPECT_TRUE(change(*client, 1));
}

TEST(PeerNode, ASilentProcessTimesOutAndAnswersWhenItGoesOn) {
  const TestDomain domain;
  PeersManager manager(domain);
  const auto peer = start_node(domain, "/peer");
  const auto client = manager.changes_state_of("/peer");
  ASSERT_TRUE(change(*client, 1));
  kill(peer->pid(), SIGSTOP);
  rtps::EventLog<CallOutcome> outcomes;
  client->probe()->call(rtps::encode(srv::GetState::Request{}), Repeat::kUntilAnswered,
                        std::chrono::milliseconds(50),
                        [&](const CallResult& result) { outcomes.add(result.outcome); });
  ASSERT_TRUE(outcomes.wait_for_count(1));
  EXPECT_EQ(outcomes.all().front(), CallOutcome::kTimedOut);
  kill(peer->pid(), SIGCONT);
  EXPECT_TRUE(change(*client, 2));
}

}  // namespace
}  // namespace culprit::ros2
