// Which parameters a command line gives to nodes: `--ros-args -p rate:=10 --params-file robot.yaml`.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace culprit::doctor {

// By node, of `nodes` (full names); values as YAML has them. Relative files are below `folder`. Unreadable files are left out.
std::map<std::string, std::map<std::string, std::string>> start_parameters(
    const std::vector<std::string>& command, const std::string& folder,
    const std::vector<std::string>& nodes);

}  // namespace culprit::doctor
