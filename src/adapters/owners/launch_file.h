// A start as a launch file describes it: LAUNCH "my_robot/robot.launch.py#driver use_sim_time:=true".
//
// The launch file is evaluated at each start, by `python3` and the package `launch` of the
// component's environment. The process that evaluates it becomes the node. So a redeploy starts
// what the launch file says now, with its parameters, remappings and variables. No other process of
// the launch file is started.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "owners/spawn.h"

namespace culprit::owners {

struct LaunchFileNode {
  std::string file;  // "/opt/robot.launch.py", or with its package: "my_robot/robot.launch.py"
  std::string node;  // "driver", "/front/driver"; of a node without a name in the file its program
};

// The node that a launch command names. Empty: it names no launch file.
std::optional<LaunchFileNode> launch_file_node(const std::vector<std::string>& launch);

// Where the file is. `prefixes`: the value of AMENT_PREFIX_PATH that the node gets; empty: places of a
// file of a package are unknown, and there is no need.
std::optional<StartNeed> need_of(const LaunchFileNode& what, const std::string& prefixes);

// The arguments of the program that `launch` means: itself, unless it names a launch file.
std::vector<std::string> program_of_launch(const std::vector<std::string>& launch,
                                           const std::string& prefixes);

// The nodes that a running `ros2 launch` has loaded into component containers. Its file is evaluated once more, with its arguments,
// in its environment and folder; no node is started or loaded. JSON, as record.json of play_launch; a parameter that is a
// text, whatever it looks like, has a third element. Errors: `pid` is no `ros2 launch` of this user, or its file cannot be evaluated within `limit`.
Expected<std::string> composed_nodes_of_launch(int pid, Duration limit);

}  // namespace culprit::owners
