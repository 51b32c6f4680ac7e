// Security of DDS as ROS 2 uses it (SROS2): one's identity, the authority that signed it, and one's
// rights.
//
// Six files in the enclave's folder of a keystore, as `ros2 security create_enclave` lays them out;
// sources: DDS Security 1.1, https://design.ros2.org/articles/ros2_security_enclaves.html.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/expected.h"

namespace culprit::ros2 {

struct Security {
  std::string enclave;           // "/culprit"
  std::filesystem::path folder;  // with the six files
};

// ROS_SECURITY_ENABLE, ROS_SECURITY_KEYSTORE, ROS_SECURITY_STRATEGY and
// ROS_SECURITY_ENCLAVE_OVERRIDE ("/culprit" unless set), as the robot's nodes read them. Nothing:
// security is off; or there is no enclave, and the strategy is not Enforce. Errors name the
// variable or the file, and what to do.
Expected<std::optional<Security>> security_from_environment(
    const std::function<const char*(const char* name)>& get);

// The properties that the middleware receives for it.
std::vector<std::pair<std::string, std::string>> properties_of(const Security& security);

}  // namespace culprit::ros2
