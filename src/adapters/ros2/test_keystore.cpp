#include "ros2/test_keystore.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

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

constexpr const char* kNewKey =
    "openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:prime256v1 -out ";

void run_in(const fs::path& folder, const std::string& command) {
  const std::string whole = "cd '" + folder.string() + "' && { " + command + "; } >/dev/null 2>&1";
  if (std::system(whole.c_str()) != 0) throw std::runtime_error("openssl fails: " + command);
}

void sign(const fs::path& folder, const std::string& what, const std::string& authority) {
  run_in(folder, "openssl smime -sign -text -in " + what + ".xml -out " + what + ".p7s -signer '" +
                     authority + "/ca.pem' -inkey '" + authority + "/ca.key'");
}

}  // namespace

TestKeystore::TestKeystore() {
  std::ofstream(folder_ / "governance.xml") << kGovernance;
  run_in(folder_, kNewKey + std::string("ca.key && openssl req -x509 -new -key ca.key -days 3650 "
                                        "-subj /CN=test_ca -out ca.pem"));
  sign(folder_, "governance", folder_);
}

fs::path TestKeystore::file(const std::string& enclave, const std::string& name) const {
  return folder_ / "enclaves" / enclave.substr(1) / name;
}

void TestKeystore::add(const std::string& enclave, const std::string& permissions) {
  const fs::path own = file(enclave, "");
  fs::create_directories(own);
  for (const char* authority : {"identity_ca.cert.pem", "permissions_ca.cert.pem"})
    fs::copy_file(folder_ / "ca.pem", own / authority);
  fs::copy_file(folder_ / "governance.p7s", own / "governance.p7s");
  std::ofstream(own / "permissions.xml") << permissions;
  sign(own, "permissions", folder_);
  run_in(own, kNewKey + std::string("key.pem && openssl req -new -key key.pem -subj '/CN=\\") +
                  enclave + "' -out c.csr && openssl x509 -req -in c.csr -CA '" + path() +
                  "/ca.pem' -CAkey '" + path() +
                  "/ca.key' -CAcreateserial -days 3650 -out cert.pem");
}

std::string TestKeystore::everything(const std::string& enclave) {
  return R"(<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name=")" +
         enclave + R"(">
  <subject_name>CN=)" +
         enclave + R"(</subject_name>
  <validity><not_before>2013-10-26T00:00:00</not_before><not_after>2043-10-26T00:00:00</not_after></validity>
  <allow_rule><domains><id_range><min>0</min><max>232</max></id_range></domains>
    <publish><topics><topic>*</topic></topics></publish>
    <subscribe><topics><topic>*</topic></topics></subscribe>
  </allow_rule>
  <default>DENY</default>
</grant></permissions>
</dds>
)";
}

}  // namespace culprit::ros2
