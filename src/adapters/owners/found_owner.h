// Finds out what runs a component whose rules do not say so, as far as the kernel can tell: a hint
// to people, who may then declare it. culprit itself never acts on it.
#pragma once

#include <optional>
#include <string>

namespace culprit::owners {

struct FoundOwner {
  std::string name;     // "systemd as lidar.service"
  std::string declare;  // "UNIT lidar.service"; empty: nothing fits
};

// The owner of the process `pid`. `loader`: the node in the same process that loads others, "/box";
// empty: none. Nothing: not known.
std::optional<FoundOwner> found_owner(int pid, const std::string& loader);

}  // namespace culprit::owners
