// An independent implementation at the other end: Cyclone DDS, with the other service mapping.
#ifdef CULPRIT_PEER_CYCLONE

#include <memory>
#include <optional>
#include <signal.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/peer_process.h"
#include "ros2/process_finder.h"
#include "ros2/services.h"
#include "ros2/test_change_state.h"
#include "ros2/timer.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

std::unique_ptr<PeerProcess> start_cyclone(const TestDomain& domain,
                                           std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {CULPRIT_PEER_CYCLONE, std::to_string(domain.number())});
  return std::make_unique<PeerProcess>(std::move(arguments));
}

std::unique_ptr<ServiceClient> changes_state(NodeEntry& node, const std::string& robot) {
  return std::move(*ServiceClient::create(
      node, {robot + "/change_state", std::string(srv::ChangeState::kType)}, rtps::qos::kServices,
      {{robot + "/get_state", std::string(srv::GetState::kType)},
       rtps::encode(srv::GetState::Request{})}));
}

// A managed node of ours.
struct CycloneSide {
  explicit CycloneSide(const TestDomain& domain) : context(domain.options()) {
    context.run([&] { node = std::move(*LifecycleNode::create(*context, {"/", "robot"}, {})); });
  }
  LiveContext context;
  std::unique_ptr<LifecycleNode> node;
};

TEST(PeerCyclone, HearsWhatWePublish) {
  const TestDomain domain;
  CycloneSide robot(domain);
  auto publisher = robot.node->node().create_publisher<msg::Float64>("/t");
  ASSERT_TRUE(publisher);
  const auto peer = start_cyclone(domain, {"echo", "/t"});
  std::optional<Timer> timer;
  robot.context.run(
      [&] { timer.emplace(robot.context->executor(), 10ms, [&] { publisher->publish({1.5}); }); });
  EXPECT_TRUE(peer->says("value 1.500000"));
  timer.reset();
}

TEST(PeerCyclone, ReadsOurDiagnostics) {
  const TestDomain domain;
  CycloneSide robot(domain);
  auto publisher = robot.node->node().create_publisher<msg::DiagnosticArray>("/diagnostics");
  ASSERT_TRUE(publisher);
  msg::DiagnosticArray array;
  msg::DiagnosticStatus& status = array.status.emplace_back();
  status.level = 2;
  status.name = "camera";
  status.values = {{"entropy", "0.5"}, {"autofocus_needed", "true"}};
  const auto peer = start_cyclone(domain, {"diagnostics"});
  std::optional<Timer> timer;
  robot.context.run(
      [&] { timer.emplace(robot.context->executor(), 10ms, [&] { publisher->publish(array); }); });
  EXPECT_TRUE(peer->says("status 2 camera entropy=0.5 autofocus_needed=true"));
  timer.reset();
}

TEST(PeerCyclone, IsHeardByUs) {
  const TestDomain domain;
  LiveContext watcher(domain.options());
  NodeEntry node(*watcher, {"/", "watcher"});
  rtps::EventLog<std::pair<double, std::int64_t>> values;
  const auto subscription = RawSubscription::create(
      node, "/t", msg::Float64::kType, rtps::qos::kSensorData, PayloadUse::kWhole,
      [&](const Sample& sample) {
        values.add({rtps::decode<msg::Float64>(sample.payload)->data, sample.identity.sequence});
      });
  ASSERT_TRUE(subscription);
  const auto peer = start_cyclone(domain, {"tick", "/t"});
  ASSERT_TRUE(values.wait_for_count(3));
  const auto all = values.all();
  EXPECT_EQ(all[2].first - all[0].first, static_cast<double>(all[2].second - all[0].second));
}

TEST(PeerCyclone, IsANodeOfTheGraph) {
  const TestDomain domain;
  Graph::Options options;
  options.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  LiveContext watcher(domain.options(), options);
  const auto peer = start_cyclone(domain, {"serve", "/cyclone"});
  ASSERT_TRUE(watcher.sees_endpoint("/cyclone", EndpointKind::kServer, "/cyclone/change_state"));
  watcher.run([&] {
    ASSERT_EQ(watcher->graph().nodes().size(), 1u);
    const GraphNode node = watcher->graph().nodes()[0].node;
    EXPECT_EQ(node.vendor, Vendor::kCyclone);
    EXPECT_EQ(node.pid, peer->pid());
  });
}

// Announcements of another implementation, read by us and by Fast DDS.
TEST(PeerCyclone, IsDiscoveredAsAllOthersByAParticipantThatNeverMeetsIt) {
  const TestDomain domain;
  ParticipantOptions never = domain.options();
  never.never_meets = [](std::string_view topic, rtps::EndpointRole) {
    return topic.starts_with("rq/") || topic.starts_with("rr/");
  };
  LiveContext past(never), through(domain.options());
  const auto endpoints = [](LiveContext& context) {
    std::vector<rtps::EndpointInfo> all;
    context.run([&] {
      for (const auto& participant : context->graph().participants()) {
        for (const auto& each : participant.endpoints)
          all.push_back(*context->graph().endpoint(each.id));
      }
    });
    return all;
  };
  const auto peer = start_cyclone(domain, {"serve", "/cyclone"});
  for (LiveContext* each : {&past, &through}) {
    ASSERT_TRUE(each->sees_endpoint("/cyclone", EndpointKind::kServer, "/cyclone/change_state"));
    ASSERT_TRUE(each->sees_endpoint("/cyclone", EndpointKind::kServer, "/cyclone/get_state"));
  }
  EXPECT_EQ(endpoints(past), endpoints(through));
}

TEST(PeerCyclone, ServesUs) {
  const TestDomain domain;
  LiveContext manager(domain.options());
  NodeEntry node(*manager, {"/", "manager"});
  const auto client = changes_state(node, "/cyclone");
  const auto peer = start_cyclone(domain, {"serve", "/cyclone"});
  for (const std::uint8_t id : {1, 3, 4}) EXPECT_TRUE(change(*client, id));
  ASSERT_TRUE(peer->lines().wait_for_count(3));
  EXPECT_THAT(peer->lines().all(), ElementsAre("change 1", "change 3", "change 4"));
}

TEST(PeerCyclone, ServesFreshManagersWithoutOneRequestLostOrDoubled) {
  const TestDomain domain;
  const auto peer = start_cyclone(domain, {"serve", "/cyclone"});
  for (std::uint8_t i = 0; i < 20; ++i) {
    LiveContext manager(domain.options());
    NodeEntry node(*manager, {"/", "manager"});
    EXPECT_TRUE(change(*changes_state(node, "/cyclone"), i)) << int{i};
  }
  ASSERT_TRUE(peer->lines().wait_for_count(20));
  const auto lines = peer->lines().all();
  ASSERT_EQ(lines.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(lines[i], "change " + std::to_string(i));
}

TEST(PeerCyclone, ServesUsAgainAtOnceAfterItWasKilled) {
  const TestDomain domain;
  Graph::Options options;
  options.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  options.is_running = [](int pid) { return kill(pid, 0) == 0; };
  LiveContext manager(domain.options(), options);
  NodeEntry node(*manager, {"/", "manager"});
  const auto client = changes_state(node, "/cyclone");
  for (int i = 0; i < 4; ++i) {
    const auto peer = start_cyclone(domain, {"serve", "/cyclone"});
    ASSERT_TRUE(manager.sees_process("/cyclone", peer->pid()));
    EXPECT_TRUE(change(*client, 1)) << i;
    peer->end(SIGKILL);
    // A request that is never acknowledged: it must neither reach the successor nor spoil the first
    // one to it.
    rtps::EventLog<CallOutcome> outcomes;
    client->call(rtps::encode(srv::ChangeState::Request{{9, ""}}), Repeat::kNever, 20ms,
                 [&](const CallResult& result) { outcomes.add(result.outcome); });
    ASSERT_TRUE(outcomes.wait_for_count(1));
    EXPECT_EQ(outcomes.all().front(), CallOutcome::kTimedOut);
    EXPECT_THAT(peer->lines().all(), ElementsAre("change 1"));
  }
}

TEST(PeerCyclone, CallsOurServices) {
  const TestDomain domain;
  CycloneSide robot(domain);
  const auto peer = start_cyclone(domain, {"call", "/robot", "1", "3", "1", "4"});
  ASSERT_TRUE(peer->lines().wait_for_count(5)) << testing::PrintToString(peer->lines().all());
  EXPECT_THAT(peer->lines().all(), ElementsAre("state 1 unconfigured", "change 1 1", "change 3 1",
                                               "change 1 0", "change 4 1"));
}

TEST(PeerCyclone, GetsEveryFirstAnswerAlsoNextToDeadClients) {
  const TestDomain domain;
  CycloneSide robot(domain);
  for (int i = 0; i < 20; ++i) {
    const auto peer = start_cyclone(domain, {"call", "/robot", i % 2 == 0 ? "1" : "2"});
    ASSERT_TRUE(peer->lines().wait_for_count(2))
        << i << ": " << testing::PrintToString(peer->lines().all());
    const std::string change = i % 2 == 0 ? "change 1 1" : "change 2 1";
    const std::string state = i % 2 == 0 ? "state 1 unconfigured" : "state 2 inactive";
    EXPECT_THAT(peer->lines().all(), ElementsAre(state, change)) << i;
  }
}

TEST(PeerCyclone, SharesAServerWithClientsOnFastDds) {
  const TestDomain domain;
  CycloneSide robot(domain);
  LiveContext manager(domain.options());
  NodeEntry node(*manager, {"/", "manager"});
  const auto client = changes_state(node, "/robot");
  EXPECT_TRUE(change(*client, 1));
  const auto peer = start_cyclone(domain, {"call", "/robot", "3"});
  EXPECT_TRUE(peer->says("change 3 1"));
  EXPECT_TRUE(change(*client, 4));
}

}  // namespace
}  // namespace culprit::ros2

#endif
