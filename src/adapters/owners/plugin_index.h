// Which classes a component container would find: those that the ament index of its own environment
// has registered (resource type rclcpp_components), read as the container reads it.
#pragma once

#include <string>

#include "base/expected.h"

namespace culprit::owners {

// Errors: the process's environment cannot be read, no prefix of its AMENT_PREFIX_PATH has such a
// package with components, or the package has no such class; with what was probably meant.
Expected<void> find_plugin(int pid, const std::string& package, const std::string& plugin);

}  // namespace culprit::owners
