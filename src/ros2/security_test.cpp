// A secured domain: keys made for the test with openssl, as an enclave's folder holds them.
#include "ros2/security.h"

#include <cstdlib>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/node.h"

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

constexpr const char* kGovernance = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
<domain_access_rules><domain_rule>
  <domains><id_range><min>0</min><max>232</max></id_range></domains>
  <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
  <enable_join_access_control>true</enable_join_access_control>
  <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
  <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
  <rtps_protection_kind>SIGN</rtps_protection_kind>
  <topic_access_rules><topic_rule>
    <topic_expression>*</topic_expression>
    <enable_discovery_protection>true</enable_discovery_protection>
    <enable_liveliness_protection>true</enable_liveliness_protection>
    <enable_read_access_control>true</enable_read_access_control>
    <enable_write_access_control>true</enable_write_access_control>
    <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
    <data_protection_kind>ENCRYPT</data_protection_kind>
  </topic_rule></topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
)";

// Everybody may say and hear everything: that permissions are kept is the middleware's.
constexpr const char* kPermissions = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="/culprit">
  <subject_name>CN=/culprit</subject_name>
  <validity><not_before>2013-10-26T00:00:00</not_before><not_after>2043-10-26T00:00:00</not_after></validity>
  <allow_rule><domains><id_range><min>0</min><max>232</max></id_range></domains>
    <publish><topics><topic>*</topic></topics></publish>
    <subscribe><topics><topic>*</topic></topics></subscribe>
  </allow_rule>
  <default>DENY</default>
</grant></permissions>
</dds>
)";

// <folder>/enclaves/culprit with its six files.
class Keystore {
 public:
  Keystore() {
    std::string name = (fs::temp_directory_path() / "culprit-keys-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    const fs::path enclave = folder_ / "enclaves" / "culprit";
    fs::create_directories(enclave);
    std::ofstream(enclave / "governance.xml") << kGovernance;
    std::ofstream(enclave / "permissions.xml") << kPermissions;
    run("cd '" + enclave.string() +
        "' && key='-algorithm EC -pkeyopt ec_paramgen_curve:prime256v1'"
        " && openssl genpkey $key -out ca.key && openssl req -x509 -new -key ca.key -days 3650"
        " -subj /CN=test_ca -out identity_ca.cert.pem && cp identity_ca.cert.pem"
        " permissions_ca.cert.pem && openssl genpkey $key -out key.pem && openssl req -new -key"
        " key.pem -subj /CN=\\\\/culprit -out c.csr && openssl x509 -req -in c.csr -CA"
        " identity_ca.cert.pem -CAkey ca.key -CAcreateserial -days 3650 -out cert.pem && for each "
        "in"
        " governance permissions; do openssl smime -sign -text -in $each.xml -out $each.p7s -signer"
        " permissions_ca.cert.pem -inkey ca.key || exit 1; done");
  }
  ~Keystore() { fs::remove_all(folder_); }
  Keystore(const Keystore&) = delete;

  std::string path() const { return folder_.string(); }
  fs::path file(const char* name) const { return folder_ / "enclaves" / "culprit" / name; }

 private:
  static void run(const std::string& command) {
    if (std::system(("{ " + command + "; } >/dev/null 2>&1").c_str()) != 0)
      throw std::runtime_error("openssl fails: " + command);
  }
  fs::path folder_;
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
  fs::remove(keys.file("permissions.p7s"));
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
  const ReaderOptions what{.topic = "rt/secret", .type = "std_msgs::msg::dds_::String_"};
  const WriterOptions same{.topic = what.topic, .type = what.type};

  EventLog<std::string> heard;
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
  watched.on_match = [&](const Guid&, Match match) {
    if (match == Match::kMade) matched.set_value();
  };
  const auto speaking = friendly->create_writer(watched);
  ASSERT_TRUE(speaking) << speaking.error();
  ASSERT_EQ(matched.get_future().wait_for(kPatience), std::future_status::ready);

  const auto payload = [](std::string text) {
    text.insert(0, std::string("\0\1\0\0", 4));
    return Bytes(text.begin(), text.end());
  };
  (*intruding)->write(payload("I am nobody "));
  (*speaking)->write(payload("I am a friend"));
  heard.wait_for_count(1);
  EXPECT_THAT(heard.all(), testing::ElementsAre(HasSubstr("I am a friend")));
}

}  // namespace
}  // namespace culprit::ros2
