// The observations of `culprit init` about a robot.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/time.h"
#include "init/launch_dump.h"
#include "language/live_inventory.h"
#include "link/rhythm.h"
#include "link/survey.h"

namespace culprit::init {

// How a process was started that is this machine's and may be looked into.
struct Start {
  std::vector<std::string> command;      // argument vector, with the program's whole path
  std::vector<std::string> environment;  // "ROS_DOMAIN_ID=7": of ROS and DDS, where it is not ours
  std::vector<std::string> withheld;     // names of other variables that are not as ours
  std::string folder;                    // that it was started in; empty: the one that we are in
  std::string owner;    // who runs it: "systemd as lidar.service"; empty: nobody can be told
  std::string declare;  // what to write then: "UNIT lidar.service"; empty: a LAUNCH
  bool operator==(const Start&) const = default;
};

struct RobotProfile {
  LiveInventory robot;
  std::map<std::string, link::Rhythm> rhythms;  // by topic
  // The same for each node that publishes the topic; by topic and node.
  std::map<std::string, std::map<std::string, link::Rhythm>> rhythms_of_publishers;
  std::map<std::string, Start> starts;  // by node, of those whose process is proven
  // For topics that command movements or measure something, by topic and field.
  std::map<std::string, std::map<std::string, link::ValueCourse>> fields;
  std::map<link::Survey::StatusKey, link::StatusCourse> statuses;
  std::set<std::string> came_late;  // nodes that were not there yet after half of the look
  std::set<std::string> left;       // nodes that were there then, and not at its end
  Duration looked{};
  std::uint32_t domain = 0;
  LaunchDump dump{};             // of what started it, if somebody gave one
  bool has_dump = false;         // somebody did
  std::string parameter_file{};  // where what the dump has of parameters is written; whole
};

}  // namespace culprit::init
