// Which packs fit a robot (rules/packs, docs/packs.md), by what was seen of it.
//
// A node is known by the package of its program, not by its name, and a template is chosen only if
// all is there that it reads and calls. So nothing is chosen for what the robot has not.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "init/robot_profile.h"

namespace culprit::init {

struct PackUse {
  std::string pack;      // "lidars": of "packs/lidars.rules"
  std::string call;      // "sick_scan_xd(lidar, /scan, 15)": what stands behind USE
  std::string evidence;  // "/scan came 15 times a second": what it was chosen by
  std::string group{};   // a GROUP statement that it is about; may be empty
  // Nodes whose loss and silence it sees, so that no other rule has to.
  std::set<std::string> nodes{};
  bool has_launcher = false;  // whoever starts them takes them through their lifecycle
  bool is_proposal = false;   // what it does is for a person to decide
};

// INCLUDE "packs/lidars.rules"
std::string include_of(const std::string& pack);

// `components` are the names of the nodes that are declared, by full name. Adds to `left_out` known nodes that lack a part that their pack needs.
std::vector<PackUse> packs_for(const RobotProfile& seen,
                               const std::map<std::string, std::string>& components,
                               std::vector<std::string>& left_out);

}  // namespace culprit::init
