// Who runs a component of which the rules do not say it, as far as the kernel tells: for people, who
// may declare it then. Nothing is done on its strength.
#pragma once

#include <optional>
#include <string>

namespace culprit::owners {

struct FoundOwner {
  std::string who;      // "systemd as lidar.service"
  std::string declare;  // "UNIT lidar.service"; empty: nothing fits
};

// Of the process `pid`. `loader`: the node in the same process that loads others, "/box"; empty: none.
// Nothing: nobody can be told.
std::optional<FoundOwner> found_owner(int pid, const std::string& loader);

}  // namespace culprit::owners
