#include "ros2/manager_lease.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kKey = "a key that only friends have";

// The writer of a participant.
Guid writer(std::uint8_t participant) {
  Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[15] = 3;
  return guid;
}

EndpointInfo says(std::uint8_t participant, const std::string& user_data) {
  return {.guid = writer(participant),
          .topic = ManagerLease::kTopic,
          .type = ManagerLease::kType,
          .user_data = user_data,
          .qos = {}};
}
EndpointInfo claim(std::uint8_t participant, LeaseClaim what) {
  if (what.key.empty()) what.key = kKey;
  const ManagerLease lease(what, writer(participant).prefix());
  return says(participant, lease.announcements().front());
}

ManagerLease lease_of(std::int64_t since, std::int64_t id = 5,
                      std::vector<std::string> nodes = {"/camera", "*/lidar"}) {
  return ManagerLease({"drone", since, id, std::move(nodes), kKey}, writer(200).prefix());
}

TEST(ManagerLease, IsOfTheOneThatBeganFirst) {
  ManagerLease lease = lease_of(100);
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(1, {"drone", 101, 1}));
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(9, {"drone", 99, 1}));
  EXPECT_EQ(lease.elder(), writer(9).prefix());
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, IsOfTheLowerIdIfTwoBeganAtOnce) {
  ManagerLease lower = lease_of(100, 1);
  ManagerLease higher = lease_of(100, 2);
  lower.apply(claim(2, {"drone", 100, 2}));
  higher.apply(claim(1, {"drone", 100, 1}));
  EXPECT_FALSE(lower.elder());
  EXPECT_TRUE(higher.elder());
}

TEST(ManagerLease, IsNotLostToOneself) {
  ManagerLease lease = lease_of(100, 7);
  lease.apply(claim(3, {"drone", 100, 7}));
  EXPECT_FALSE(lease.elder());
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, PassesOnWhenTheElderIsGone) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"drone", 98, 1}));
  lease.apply(claim(2, {"drone", 99, 1}));
  lease.apply(EndpointGone{writer(1)});
  EXPECT_EQ(lease.elder(), writer(2).prefix());
  Guid participant = writer(2);
  participant.bytes[15] = 0xc1;
  lease.apply(ParticipantGone{participant});
  EXPECT_FALSE(lease.elder());
}

TEST(ManagerLease, IsOfOneRobotOnlyAndIgnoresNonsense) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"rover", 1, 1}));
  lease.apply(says(2, "robot=drone;since=early;id=1;"));
  lease.apply(says(3, "robot=drone;since=1x;id=1;"));
  lease.apply(says(4, ""));
  EndpointInfo other = claim(6, {"drone", 1, 1});
  other.topic = "rt/chatter";
  lease.apply(other);
  EXPECT_FALSE(lease.elder());
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, IsNotLostToAStranger) {
  ManagerLease lease = lease_of(100);
  lease.apply(
      claim(1, {.robot = "drone", .since = 1, .id = 1, .key = "guessed key of a stranger"}));
  lease.apply(says(2, "robot=drone;since=1;id=2;nodes=;"));
  lease.apply(says(3, "robot=drone;since=1;id=3;nodes=;proof=00;"));
  // Repeats what a friend said.
  lease.apply(says(4, claim(9, {"drone", 1, 1}).user_data));
  EXPECT_FALSE(lease.elder());
  EXPECT_EQ(lease.strangers().size(), 4u);
  EXPECT_EQ(lease.strangers([](const GuidPrefix& p) { return p.bytes[0] != 2; }).size(), 1u);
}

TEST(ManagerLease, WithoutAKeyEverybodyIsAStranger) {
  ManagerLease lease({"drone", 100, 5, {}, ""}, writer(200).prefix());
  lease.apply(claim(1, {"drone", 1, 1}));
  lease.apply(says(2, "robot=drone;since=1;id=2;nodes=;proof=;"));
  EXPECT_FALSE(lease.elder());
  EXPECT_EQ(lease.strangers().size(), 2u);
}

TEST(ManagerLease, OfANodeIsOfTheOneThatBeganFirstWhateverItsRobotIsCalled) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"rover", 99, 1, {"/camera", "/arm"}}));
  lease.apply(claim(2, {"boat", 98, 1, {"/deck/lidar"}}));
  lease.apply(claim(3, {"plane", 101, 1, {"/camera"}}));
  EXPECT_FALSE(lease.elder());
  EXPECT_EQ(lease.elder_at("/camera"), writer(1).prefix());
  EXPECT_EQ(lease.elder_at("/deck/lidar"), writer(2).prefix());
  EXPECT_FALSE(lease.elder_at("/stern/lidar"));
  EXPECT_FALSE(lease.elder_at("/wheel"));
  EXPECT_FALSE(lease.elder_at("/camera", [](const GuidPrefix& p) { return p.bytes[0] == 1; }));
}

TEST(ManagerLease, NamesEveryNodeOfARobotHoweverMany) {
  std::vector<std::string> nodes;
  for (int i = 0; i < 60; ++i)
    nodes.push_back("/a/namespace/of/some/length/node_" + std::to_string(i));
  const LeaseClaim many{"fleet", 1, 1, nodes, kKey};
  ManagerLease lease = lease_of(100, 5, nodes);
  const auto said = ManagerLease(many, writer(1).prefix()).announcements();
  EXPECT_GT(said.size(), 1u);
  for (std::size_t i = 0; i < said.size(); ++i) {
    EXPECT_LT(said[i].size(), 1024u);
    EndpointInfo info = says(1, said[i]);
    info.guid.bytes[14] = static_cast<std::uint8_t>(i);
    lease.apply(info);
  }
  for (const std::string& node : nodes) EXPECT_TRUE(lease.elder_at(node)) << node;
}

}  // namespace
}  // namespace culprit::ros2
