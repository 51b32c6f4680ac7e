#include "ros2/manager_lease.h"

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

// The writer of a participant.
Guid writer(std::uint8_t participant) {
  Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[15] = 3;
  return guid;
}

EndpointInfo claim(std::uint8_t participant, const std::string& user_data) {
  return {.guid = writer(participant),
          .topic = ManagerLease::kTopic,
          .type = ManagerLease::kType,
          .user_data = user_data,
          .qos = {}};
}
EndpointInfo claim(std::uint8_t participant, const LeaseClaim& what) {
  return claim(participant, ManagerLease(what).user_data());
}

ManagerLease lease_of(std::int64_t since, std::int64_t id = 5) {
  return ManagerLease({"drone", since, id});
}

TEST(ManagerLease, IsOfTheOneThatBeganFirst) {
  ManagerLease lease = lease_of(100);
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(1, {"drone", 101, 1}));
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(9, {"drone", 99, 1}));
  EXPECT_EQ(lease.elder(), writer(9).prefix());
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
  lease.apply(claim(2, "robot=drone;since=early;id=1;"));
  lease.apply(claim(3, "robot=drone;since=1x;id=1;"));
  lease.apply(claim(4, ""));
  EndpointInfo other = claim(6, {"drone", 1, 1});
  other.topic = "rt/chatter";
  lease.apply(other);
  EXPECT_FALSE(lease.elder());
}

}  // namespace
}  // namespace culprit::ros2
