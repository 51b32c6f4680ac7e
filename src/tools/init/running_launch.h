// How the components of containers were loaded, from the `ros2 launch` that runs: without a dump of its launch file.
#pragma once

#include <string>
#include <vector>

#include "init/launch_dump.h"
#include "language/live_inventory.h"

namespace culprit::init {

struct RunningLaunch {
  LaunchDump dump;
  std::vector<std::string> notes;  // for people: what could not be found out
};

// Looks for containers whose processes on this machine were started by a `ros2 launch` of this user. Evaluates its launch file once
// more, which may take some seconds.
RunningLaunch running_launch(const LiveInventory& robot);

}  // namespace culprit::init
