#include "ros2/context.h"

#include <memory>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/process_finder.h"
#include "ros2/publisher.h"
#include "ros2/subscription.h"
#include "ros2/type_description.h"

namespace culprit::ros2 {
namespace {

// A participant that is no ROS 2 context: it reads and writes ros_discovery_info by hand.
class Stranger {
 public:
  explicit Stranger(const TestDomain& domain)
      : participant_(std::move(*Participant::create(domain.options(), [](DiscoveryEvent) {}))) {
    writer_ = std::move(*participant_->create_writer({std::string(kDiscoveryInfoTopic),
                                                      std::string(kDiscoveryInfoType),
                                                      rtps::qos::kDiscoveryInfoWriter,
                                                      "",
                                                      {}}));
    reader_ = std::move(
        *participant_->create_reader({std::string(kDiscoveryInfoTopic),
                                      std::string(kDiscoveryInfoType),
                                      rtps::qos::kDiscoveryInfoReader,
                                      PayloadUse::kWhole,
                                      "",
                                      {}},
                                     [this](const Sample& sample) {
                                       heard_.add({sample.payload.begin(), sample.payload.end()});
                                     }));
  }

  void says(const NodeEntities& node, GidSize size) {
    writer_->write(encode_discovery_info({participant_->guid(), {node}}, size));
  }
  void says(const rtps::Bytes& payload) { writer_->write(payload); }
  rtps::EventLog<rtps::Bytes>& heard() { return heard_; }
  Participant& participant() { return *participant_; }

 private:
  rtps::EventLog<rtps::Bytes> heard_;
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Writer> writer_;
  std::unique_ptr<Reader> reader_;
};

bool names_a_node(const rtps::Bytes& payload, const std::string& name) {
  const auto info = decode_discovery_info(payload);
  return info && info->nodes.size() == 1 && info->nodes.front().name == name;
}

TEST(Context, TwoNodesSeeEachOther) {
  const TestDomain domain;
  LiveContext one(domain.options()), other(domain.options());
  const NodeEntry a(*one, {"/ns", "a"});
  const NodeEntry b(*other, {"/", "b"});
  EXPECT_TRUE(one.sees_node("/b"));
  EXPECT_TRUE(other.sees_node("/ns/a"));
}

// As nodes of Iron and newer do with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST: they announce an address of the network.
TEST(Context, ANodeOnLoopbackAloneDiscoversTheNodesOfThisMachineThatUseAllAddresses) {
  const TestDomain domain;
  ParticipantOptions all_addresses = domain.options();
  all_addresses.reach = Reach::kSubnet;
  LiveContext one(domain.options()), other(all_addresses);
  const NodeEntry a(*one, {"/", "a"});
  const NodeEntry b(*other, {"/", "b"});
  EXPECT_TRUE(one.sees_node("/b"));
  EXPECT_TRUE(other.sees_node("/a"));
}

TEST(Context, EndpointsComeAndGoWithTheirOwners) {
  const TestDomain domain;
  LiveContext watcher(domain.options()), robot(domain.options());
  NodeEntry node(*robot, {"/", "a"});
  auto publisher = RawPublisher::create(node, "~/t", msg::Float64::kType, rtps::qos::kDefault);
  auto subscription = Subscription::create(node, "t", msg::Float64::kType, rtps::qos::kDefault,
                                           [](rtps::ByteView) {});
  ASSERT_TRUE(publisher);
  ASSERT_TRUE(subscription);
  EXPECT_TRUE(watcher.sees_endpoint("/a", EndpointKind::kPublisher, "/a/t"));
  EXPECT_TRUE(watcher.sees_endpoint("/a", EndpointKind::kSubscriber, "/t"));
  publisher = Error{"gone"};
  EXPECT_TRUE(watcher.changes().wait_for_one([](const GraphChange& change) {
    const auto* left = std::get_if<EndpointLeft>(&change);
    return left != nullptr && left->name == "/a/t";
  }));
}

TEST(Context, ANodeThatLeavesIsSeenToLeaveWithoutItsProcess) {
  const TestDomain domain;
  LiveContext watcher(domain.options()), robot(domain.options());
  const NodeEntry stays(*robot, {"/", "stays"});
  auto leaves = std::make_unique<NodeEntry>(*robot, NodeName{"/", "leaves"});
  ASSERT_TRUE(watcher.sees_node("/leaves"));
  leaves.reset();
  EXPECT_TRUE(watcher.sees_node_leave("/leaves"));
}

TEST(Context, KnowsTheProcessOfANode) {
  const TestDomain domain;
  Graph::Options graph;
  graph.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  LiveContext watcher(domain.options(), graph), robot(domain.options());
  const NodeEntry node(*robot, {"/", "a"});
  ASSERT_TRUE(watcher.sees_node("/a"));
  watcher.run([&] {
    ASSERT_EQ(watcher->graph().nodes().size(), 1u);
    EXPECT_EQ(watcher->graph().nodes()[0].node.pid, getpid());
  });
}

TEST(Context, SpeaksWithTheGidSizeOfItsFirstPeer) {
  for (const GidSize size : {GidSize::kIronAndNewer, GidSize::kHumbleAndOlder}) {
    const TestDomain domain;
    ParticipantOptions options = domain.options();
    options.gid_size.reset();
    Stranger stranger(domain);
    stranger.says({"/", "stranger", {}, {}}, size);
    LiveContext context(options);
    const NodeEntry node(*context, {"/", "a"});
    ASSERT_TRUE(context.sees_node("/stranger"));
    ASSERT_TRUE(stranger.heard().wait_for_one(
        [](const rtps::Bytes& payload) { return names_a_node(payload, "a"); }));
    for (const rtps::Bytes& payload : stranger.heard().all()) EXPECT_EQ(gid_size_of(payload), size);
  }
}

TEST(Context, TakesATypeHashForASignOfNewerPeers) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.gid_size.reset();
  LiveContext context(options);
  const NodeEntry node(*context, {"/", "a"});
  Stranger stranger(domain);
  const auto hashed =
      stranger.participant().create_writer({"rt/t", "T", {}, "typehash=RIHS01_00;", {}});
  ASSERT_TRUE(hashed);
  ASSERT_TRUE(stranger.heard().wait_for_count(1));
  EXPECT_EQ(gid_size_of(stranger.heard().all().back()), GidSize::kIronAndNewer);
}

// It announces hashes wherever it is.
TEST(Context, TakesATypeHashOfACulpritForNoSign) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.gid_size.reset();
  LiveContext context(options);
  const NodeEntry node(*context, {"/", "a"});
  Stranger culprit(domain);
  const auto hashed = culprit.participant().create_writer(
      {"rt/t", "T", {}, type_user_data("RIHS01_00", "RIHS01_01"), {}});
  ASSERT_TRUE(hashed);
  ASSERT_TRUE(culprit.heard().wait_for_count(1));
  EXPECT_EQ(gid_size_of(culprit.heard().all().front()), GidSize::kHumbleAndOlder);
}

TEST(Context, SpeaksAsHumbleDoesWhenPeersAreSilent) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.gid_size.reset();
  LiveContext context(options);
  const NodeEntry node(*context, {"/", "a"});
  Stranger silent(domain);
  ASSERT_TRUE(silent.heard().wait_for_count(1));
  EXPECT_EQ(gid_size_of(silent.heard().all().front()), GidSize::kHumbleAndOlder);
}

TEST(Context, SurvivesNonsenseFromAPeer) {
  const TestDomain domain;
  LiveContext context(domain.options());
  Stranger stranger(domain);
  stranger.says(rtps::Bytes{0, 1, 0, 0});
  stranger.says(rtps::Bytes{9, 9, 9, 9, 9});
  stranger.says(rtps::Bytes(60, 0xff));
  rtps::Guid other;
  other.bytes[0] = 1;
  stranger.says(
      encode_discovery_info({other, {{"/", "of_another", {}, {}}}}, GidSize::kHumbleAndOlder));
  stranger.says({"/", "good", {}, {}}, GidSize::kHumbleAndOlder);
  EXPECT_TRUE(context.sees_node("/good"));
  EXPECT_FALSE([&] {
    for (const GraphChange& change : context.changes().all()) {
      const auto* joined = std::get_if<NodeJoined>(&change);
      if (joined != nullptr && joined->node.name == "/of_another") return true;
    }
    return false;
  }());
}

TEST(Context, ChangesMadeInOneGoAreAnnouncedOnce) {
  const TestDomain domain;
  Stranger stranger(domain);
  LiveContext context(domain.options());
  NodeEntry node(*context, {"/", "a"});
  ASSERT_TRUE(stranger.heard().wait_for_one(
      [](const rtps::Bytes& payload) { return names_a_node(payload, "a"); }));
  const std::size_t before = stranger.heard().all().size();
  context.run([&] {
    for (std::uint8_t i = 1; i <= 50; ++i) {
      rtps::Guid guid = context->participant().guid();
      guid.bytes[12] = i;
      guid.bytes[15] = 3;
      node.add(guid);
    }
  });
  ASSERT_TRUE(stranger.heard().wait_for_one([](const rtps::Bytes& payload) {
    const auto info = decode_discovery_info(payload);
    return info && !info->nodes.empty() && info->nodes.front().writers.size() == 50;
  }));
  EXPECT_EQ(stranger.heard().all().size(), before + 1);
}

TEST(Context, UniqueIdsAreUnique) {
  const TestDomain domain;
  LiveContext one(domain.options()), other(domain.options());
  const std::string first = one->unique_id();
  EXPECT_NE(first, one->unique_id());
  EXPECT_NE(first, other->unique_id());
}

}  // namespace
}  // namespace culprit::ros2
