// Which process of this machine is behind a participant?
//
// What a participant says of itself is only a claim: its process id (inside a container, process
// ids count from one), and the port that it listens on. Anybody can announce the port of somebody
// else. Proof is one process that holds both
//
// - the sockets that are bound to every address of this machine that the participant announces, and
// - the sockets that its datagrams came from, all of them (datagram_sources.h), each made by the
//   user that the process runs as, and none of another process: who shares a port may send from it.
//
// Somebody on the network has no socket here, so whatever he says leads to no process. The kernel
// knows which socket is bound to which address (/proc/net/udp), and which process holds that socket
// (/proc/<pid>/fd). Files of other users' processes cannot be seen without the right to: those are
// not proven. But all sockets are known: one that nobody has any more proves that whoever had it on
// this machine is gone.
#pragma once

#include <filesystem>
#include <functional>

#include "ros2/graph.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

class ProcessFinder {
 public:
  // `proc` is where the proc file system is mounted.
  explicit ProcessFinder(std::filesystem::path proc = "/proc");

  // Milliseconds, when it has to look through all processes. Of another machine, or of another
  // network namespace, nothing is missing: there is no process here.
  FoundProcess find(const ParticipantInfo& participant) const;

  // The process that speaks in the participant's name, though others may do so, too: it holds all that is announced,
  // and one of the sockets that datagrams came from. 0: there is none. What was said in that name before may be
  // somebody else's word, so this is no proof of what runs there.
  int speaker(const ParticipantInfo& participant) const;

  // Not one that has ended and was not reaped: where nobody reaps, it keeps its number for good.
  bool is_running(int pid) const;

 private:
  FoundProcess prove(const ParticipantInfo& participant, std::vector<UdpAddress> addresses,
                     bool may_be_elsewhere) const;
  bool has_ended(const ParticipantInfo& participant) const;
  int oldest(int said, const std::function<bool(const std::filesystem::path&)>& is_it) const;

  std::filesystem::path proc_;
};

}  // namespace culprit::ros2
