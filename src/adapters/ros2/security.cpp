#include "ros2/security.h"

#include <array>
#include <unistd.h>

#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

struct File {
  const char* property;
  const char* name;
};
constexpr std::array kFiles = {
    File{"auth.builtin.PKI-DH.identity_ca", "identity_ca.cert.pem"},
    File{"auth.builtin.PKI-DH.identity_certificate", "cert.pem"},
    File{"auth.builtin.PKI-DH.private_key", "key.pem"},
    File{"access.builtin.Access-Permissions.permissions_ca", "permissions_ca.cert.pem"},
    File{"access.builtin.Access-Permissions.governance", "governance.p7s"},
    File{"access.builtin.Access-Permissions.permissions", "permissions.p7s"}};

}  // namespace

Expected<std::optional<Security>> security_from_environment(
    const std::function<const char*(const char* name)>& get) {
  const auto value = [&](const char* name) {
    const char* text = get(name);
    return std::string(text == nullptr ? "" : text);
  };
  if (value("ROS_SECURITY_ENABLE") != "true") return std::optional<Security>();
  const std::string keystore = value("ROS_SECURITY_KEYSTORE");
  if (keystore.empty())
    return Error{
        "ROS_SECURITY_ENABLE is true, and ROS_SECURITY_KEYSTORE does not name the keys' folder"};
  Security security;
  security.enclave = value("ROS_SECURITY_ENCLAVE_OVERRIDE");
  if (security.enclave.empty()) security.enclave = "/culprit";
  if (security.enclave.front() != '/' || security.enclave.find("..") != std::string::npos)
    return Error{"ROS_SECURITY_ENCLAVE_OVERRIDE is '" + printable(security.enclave) +
                 "'; an enclave is a path such as /culprit"};
  security.folder = fs::path(keystore) / "enclaves" / security.enclave.substr(1);
  for (const File& file : kFiles) {
    const fs::path path = security.folder / file.name;
    if (access(path.c_str(), R_OK) == 0) continue;
    if (value("ROS_SECURITY_STRATEGY") != "Enforce") return std::optional<Security>();
    return Error{"cannot read '" + path.string() +
                 "', which ROS_SECURITY_STRATEGY Enforce needs; make it with: ros2 security "
                 "create_enclave " +
                 keystore + " " + security.enclave};
  }
  return std::optional(security);
}

std::vector<std::pair<std::string, std::string>> properties_of(const Security& security) {
  std::vector<std::pair<std::string, std::string>> properties = {
      {"dds.sec.auth.plugin", "builtin.PKI-DH"},
      {"dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC"},
      {"dds.sec.access.plugin", "builtin.Access-Permissions"}};
  for (const File& file : kFiles)
    properties.emplace_back("dds.sec." + std::string(file.property),
                            "file://" + fs::absolute(security.folder / file.name).string());
  return properties;
}

}  // namespace culprit::ros2
