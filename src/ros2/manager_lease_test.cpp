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

ManagerLease lease_of(std::uint8_t participant, std::int64_t since) {
  ManagerLease lease({"drone", since});
  lease.set_guid(writer(participant));
  return lease;
}

TEST(ManagerLease, IsOfTheOneThatBeganFirst) {
  ManagerLease lease = lease_of(5, 100);
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(1, {"drone", 101}));
  EXPECT_FALSE(lease.elder());
  lease.apply(claim(9, {"drone", 99}));
  EXPECT_EQ(lease.elder(), writer(9).prefix());
}

TEST(ManagerLease, IsOfTheLowerGuidIfTwoBeganAtOnce) {
  ManagerLease lower = lease_of(1, 100);
  ManagerLease higher = lease_of(2, 100);
  lower.apply(claim(2, {"drone", 100}));
  higher.apply(claim(1, {"drone", 100}));
  EXPECT_FALSE(lower.elder());
  EXPECT_TRUE(higher.elder());
}

TEST(ManagerLease, PassesOnWhenTheElderIsGone) {
  ManagerLease lease = lease_of(5, 100);
  lease.apply(claim(1, {"drone", 98}));
  lease.apply(claim(2, {"drone", 99}));
  lease.apply(EndpointGone{writer(1)});
  EXPECT_EQ(lease.elder(), writer(2).prefix());
  Guid participant = writer(2);
  participant.bytes[15] = 0xc1;
  lease.apply(ParticipantGone{participant});
  EXPECT_FALSE(lease.elder());
}

TEST(ManagerLease, IsOfOneRobotOnlyAndIgnoresNonsense) {
  ManagerLease lease = lease_of(5, 100);
  lease.apply(claim(1, {"rover", 1}));
  lease.apply(claim(2, "robot=drone;since=early;"));
  lease.apply(claim(3, "robot=drone;since=1x;"));
  lease.apply(claim(4, ""));
  EndpointInfo other = claim(6, {"drone", 1});
  other.topic = "rt/chatter";
  lease.apply(other);
  EXPECT_FALSE(lease.elder());
}

}  // namespace
}  // namespace culprit::ros2
