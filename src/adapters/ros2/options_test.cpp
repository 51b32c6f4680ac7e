#include "ros2/options.h"

#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

Expected<ParticipantOptions> options_with(std::map<std::string, std::string> variables) {
  return options_from_environment([variables](const char* name) -> const char* {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

TEST(Options, DefaultToDomainZeroAndTheSubnet) {
  const auto options = options_with({});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->domain, 0u);
  EXPECT_EQ(options->reach, Reach::kSubnet);
  EXPECT_TRUE(options->peers.empty());
}

TEST(Options, ReadTheDomain) {
  EXPECT_EQ(options_with({{"ROS_DOMAIN_ID", "42"}})->domain, 42u);
  EXPECT_EQ(options_with({{"ROS_DOMAIN_ID", "232"}})->domain, 232u);
  EXPECT_EQ(options_with({{"ROS_DOMAIN_ID", ""}})->domain, 0u);
}

TEST(Options, RefuseWhatIsNoDomain) {
  for (const char* bad : {"233", "-1", "x", "1x", " 1", "99999999999"}) {
    const auto options = options_with({{"ROS_DOMAIN_ID", bad}});
    ASSERT_FALSE(options) << bad;
    EXPECT_THAT(options.error(), StartsWith("ROS_DOMAIN_ID is '" + std::string(bad) + "'; "));
  }
}

TEST(Options, ReadHowFarTheyReach) {
  EXPECT_EQ(options_with({{"ROS_LOCALHOST_ONLY", "1"}})->reach, Reach::kLocalhost);
  EXPECT_EQ(options_with({{"ROS_LOCALHOST_ONLY", "0"}})->reach, Reach::kSubnet);
  EXPECT_EQ(options_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}})->reach,
            Reach::kLocalhost);
  EXPECT_EQ(options_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}})->reach, Reach::kSubnet);
  EXPECT_EQ(options_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}})->reach,
            Reach::kSubnet);
}

TEST(Options, TheOlderVariableWins) {
  const auto options =
      options_with({{"ROS_LOCALHOST_ONLY", "1"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}});
  EXPECT_EQ(options->reach, Reach::kLocalhost);
}

TEST(Options, RefuseToDiscoverNothing) {
  EXPECT_FALSE(options_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}));
  EXPECT_FALSE(options_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "far"}}));
  EXPECT_FALSE(options_with({{"ROS_LOCALHOST_ONLY", "yes"}}));
}

TEST(Options, ReadStaticPeers) {
  EXPECT_THAT(options_with({{"ROS_STATIC_PEERS", "192.168.0.1;;robot.local;"}})->peers,
              ElementsAre("192.168.0.1", "robot.local"));
}

TEST(Options, ReadDiscoveryServers) {
  EXPECT_THAT(
      options_with({{"ROS_DISCOVERY_SERVER", "192.168.0.1:11888;;robot.local;UDPv4:[10.0.0.1]:7"}})
          ->servers,
      ElementsAre(DiscoveryServer{0, "192.168.0.1", 11888},
                  DiscoveryServer{2, "robot.local", 11811}, DiscoveryServer{3, "10.0.0.1", 7}));
  EXPECT_TRUE(options_with({{"ROS_DISCOVERY_SERVER", ""}})->servers.empty());
  for (const char* bad : {"TCPv4:[10.0.0.1]:7", "10.0.0.1:0", "10.0.0.1:x", ":11811", "[::1]:11811",
                          "10.0.0.1:99999"}) {
    const auto options = options_with({{"ROS_DISCOVERY_SERVER", bad}});
    ASSERT_FALSE(options) << bad;
    EXPECT_THAT(options.error(), StartsWith("ROS_DISCOVERY_SERVER is '" + std::string(bad)));
  }
}

TEST(Options, ResolveAddressesAndNames) {
  EXPECT_EQ(*resolve_peer("192.168.0.1"), "192.168.0.1");
  EXPECT_EQ(*resolve_peer("localhost"), "127.0.0.1");
  EXPECT_THAT(resolve_peer("no such host").error(),
              StartsWith("the peer 'no such host' cannot be found: "));
}

}  // namespace
}  // namespace culprit::ros2
