#include "live/node_name.h"

#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::live {
namespace {

// A domain that no other test of this machine has: names of nodes are claimed, nothing is joined.
ros2::ParticipantOptions own_domain() {
  ros2::ParticipantOptions options;
  options.domain = 1'000'000 + static_cast<std::uint32_t>(getpid());
  return options;
}

TEST(NodeNameClaim, GivesEachCulpritOfADomainANameOfItsOwn) {
  std::optional<NodeNameClaim> first(own_domain());
  const NodeNameClaim second(own_domain());
  EXPECT_EQ(first->name(), "culprit");
  EXPECT_EQ(second.name(), "culprit_2");
  ros2::ParticipantOptions other = own_domain();
  other.domain += 1'000'000;
  EXPECT_EQ(NodeNameClaim(other).name(), "culprit") << "on another domain nobody is in the way";
  first.reset();
  EXPECT_EQ(NodeNameClaim(own_domain()).name(), "culprit") << "it is free again";
  EXPECT_EQ(second.name(), "culprit_2") << "who has a name keeps it";
}

TEST(NodeNameClaim, IsCalledAsItsKeysPermit) {
  ros2::ParticipantOptions secured = own_domain();
  secured.security.emplace();
  const NodeNameClaim first(secured);
  EXPECT_EQ(NodeNameClaim(secured).name(), "culprit");
}

}  // namespace
}  // namespace culprit::live
