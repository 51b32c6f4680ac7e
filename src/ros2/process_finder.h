// Which process of this machine is behind a participant?
//
// What a participant says of its process id is only a claim: inside a container, process ids count
// from one. Proof is the UDP port that it announces for discovery. The kernel knows which socket is
// bound to it (/proc/net/udp), and which process holds that socket (/proc/<pid>/fd). Files of other
// users' processes cannot be seen; there the claim has to do.
#pragma once

#include <filesystem>

#include "ros2/participant.h"

namespace culprit::ros2 {

class ProcessFinder {
 public:
  // `proc` is where the proc file system is mounted.
  explicit ProcessFinder(std::filesystem::path proc = "/proc");

  // The process id here, or 0 when it cannot be told: another machine, another network namespace.
  // Milliseconds, when it has to look through all processes.
  int find(const ParticipantInfo& participant) const;

 private:
  std::filesystem::path proc_;
};

}  // namespace culprit::ros2
