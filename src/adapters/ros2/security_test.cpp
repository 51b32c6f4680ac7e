// A secured domain, with keys made for the test.
#include "ros2/security.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/node.h"
#include "ros2/test_keystore.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Expected<std::optional<Security>> security_with(std::map<std::string, std::string> variables) {
  return security_from_environment([variables](const char* name) -> const char* {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

// With the keys of /culprit.
struct Keystore : TestKeystore {
  Keystore() { add("/culprit", everything("/culprit")); }
};

TEST(Security, IsOffUnlessItIsEnabled) {
  EXPECT_FALSE(*security_with({{"ROS_SECURITY_KEYSTORE", "/nowhere"}}));
}

TEST(Security, NamesTheFileThatIsMissingIfItIsEnforced) {
  const Keystore keys;
  std::map<std::string, std::string> variables = {{"ROS_SECURITY_ENABLE", "true"}};
  EXPECT_THAT(security_with(variables).error(), HasSubstr("ROS_SECURITY_KEYSTORE"));
  variables["ROS_SECURITY_KEYSTORE"] = keys.path();
  ASSERT_TRUE(*security_with(variables));
  fs::remove(keys.file("/culprit", "permissions.p7s"));
  EXPECT_FALSE(*security_with(variables)) << "permissive";
  variables["ROS_SECURITY_STRATEGY"] = "Enforce";
  EXPECT_THAT(security_with(variables).error(), HasSubstr("permissions.p7s"));
  variables["ROS_SECURITY_ENCLAVE_OVERRIDE"] = "/../..";
  EXPECT_THAT(security_with(variables).error(), HasSubstr("ROS_SECURITY_ENCLAVE_OVERRIDE"));
}

TEST(Security, HearsThoseWithKeysAndNoOthers) {
  const Keystore keys;
  const TestDomain domain;
  ParticipantOptions secured = domain.options();
  secured.security =
      **security_with({{"ROS_SECURITY_ENABLE", "true"}, {"ROS_SECURITY_KEYSTORE", keys.path()}});
  ReaderOptions what;
  what.topic = "rt/secret";
  what.type = "std_msgs::msg::dds_::String_";
  WriterOptions same;
  same.topic = what.topic;
  same.type = what.type;

  rtps::EventLog<std::string> heard;
  const auto open = [&](const ParticipantOptions& options) {
    auto participant = Participant::create(options, [](DiscoveryEvent) {});
    if (!participant) throw std::runtime_error(participant.error());
    return std::move(*participant);
  };
  const auto listener = open(secured);
  const auto reader = listener->create_reader(what, [&](const Sample& sample) {
    heard.add(std::string(sample.payload.begin() + 4, sample.payload.end()));
  });
  ASSERT_TRUE(reader) << reader.error();
  const auto intruder = open(domain.options());
  const auto intruding = intruder->create_writer(same);
  ASSERT_TRUE(intruding) << intruding.error();
  const auto friendly = open(secured);
  std::promise<void> matched;
  WriterOptions watched = same;
  watched.on_match = [&](const rtps::Guid&, Match match) {
    if (match == Match::kMade) matched.set_value();
  };
  const auto speaking = friendly->create_writer(watched);
  ASSERT_TRUE(speaking) << speaking.error();
  ASSERT_EQ(matched.get_future().wait_for(rtps::kPatience), std::future_status::ready);

  const auto payload = [](std::string text) {
    text.insert(0, std::string("\0\1\0\0", 4));
    return rtps::Bytes(text.begin(), text.end());
  };
  (*intruding)->write(payload("I am nobody "));
  (*speaking)->write(payload("I am a friend"));
  heard.wait_for_count(1);
  EXPECT_THAT(heard.all(), testing::ElementsAre(HasSubstr("I am a friend")));
}

}  // namespace
}  // namespace culprit::ros2
