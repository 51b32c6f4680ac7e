// Which process of this machine is behind a participant whose sockets are not seen: over a helper program
// (helper_participant.h) a middleware shows neither sockets nor processes.
//
// A process is proven to be a node's by what nobody on the network can make: it runs here, has a ROS middleware
// loaded, and one of these holds:
// - its command line is the LAUNCH of the node's component, or names the node (`__node:=`);
// - culprit started it for the component (owners/mark.h);
// - LAUNCH names a launch file, what started it runs that file, and its command line has the node's own name.
// And it is of culprit's user: another user can give a process any command line and environment.
// Fast DDS also announces the process id; then that must agree. Two processes that fit are no proof.
#pragma once

#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

#include "ros2/graph.h"

namespace culprit::link {

class NamedProcess {
 public:
  struct Sought {
    std::string node;                   // its full name
    std::vector<std::string> launch{};  // of its component; may be empty
    std::string mark{};                 // the component's: "0/sunset/camera"; empty: it is none
  };

  // `proc` is where the proc file system is mounted. `user`: whose processes count.
  explicit NamedProcess(std::filesystem::path proc = "/proc", unsigned user = geteuid());

  // The process of a participant with these nodes. Milliseconds: it looks through all processes.
  ros2::FoundProcess find(const ros2::ParticipantInfo& participant,
                          const std::vector<Sought>& nodes) const;

 private:
  std::filesystem::path proc_;
  unsigned user_;
};

// Whether a command line names the node: "--ros-args -r __node:=camera -r __ns:=/front".
bool names_node(const std::vector<std::string>& words, const std::string& node);
// Whether a process with this command line is what `launch` starts: the same words, also behind an interpreter, or the
// program that "ros2 run package program" runs.
bool is_launched_as(const std::vector<std::string>& words, const std::vector<std::string>& launch);
// Whether `starter`, the command line of what started it, runs the file of "robot.launch.py#driver", and it is for the node.
bool is_of_launch_file(const std::vector<std::string>& words,
                       const std::vector<std::string>& starter,
                       const std::vector<std::string>& launch, const std::string& node);

}  // namespace culprit::link
