// Which process of this machine is behind a participant?
//
// A participant's announcement is only a claim: its process id (inside a container, process ids
// count from one), and the port that it listens on. Anybody can announce the port of somebody else.
// A process is proven if it holds both
//
// - the sockets that are bound to every address of this machine that the participant announces, and
// - all sockets that its datagrams came from (datagram_sources.h). The user that the process runs as
//   must have made each of them, and no other process may hold one: it could send from that port.
//
// A sender on the network has no socket here, so its claims lead to no process. The kernel knows
// which socket is bound to which address (/proc/net/udp), and which process holds that socket
// (/proc/<pid>/fd). Files of other users' processes are unreadable without the right to: such
// processes are not proven. But all sockets are known: if no process has a socket any more, the
// participant that had it on this machine is gone.
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

  // Milliseconds, when it has to look through all processes. For another machine or network
  // namespace, nothing is missing: there is no process here.
  FoundProcess find(const ParticipantInfo& participant) const;

  // The process that speaks in the participant's name, though others may do so, too: it holds all
  // announced sockets, and one of the sockets that datagrams came from. 0: none. Another process
  // may have sent earlier datagrams in that name, so this does not prove which program runs there.
  int speaker(const ParticipantInfo& participant) const;

  // Not one that has ended and was not reaped: if it is never reaped, it keeps its PID for good.
  bool is_running(int pid) const;

 private:
  FoundProcess prove(const ParticipantInfo& participant, std::vector<rtps::UdpAddress> addresses,
                     bool may_be_elsewhere) const;
  bool has_ended(const ParticipantInfo& participant) const;
  int oldest(int said, const std::function<bool(const std::filesystem::path&)>& is_it) const;

  std::filesystem::path proc_;
};

}  // namespace culprit::ros2
