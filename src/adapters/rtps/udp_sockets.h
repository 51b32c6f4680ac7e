// The UDP sockets of this machine, from the kernel's tables: /proc/thread-self/net/udp and udp6
// (proc(5)). They are those of the calling thread's network namespace; of all of its processes,
// whichever user runs them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "rtps/datagram_sources.h"

namespace culprit::rtps {

struct UdpSocket {
  UdpAddress address;  // ip 0.0.0.0: it is bound to none; of IPv6 the last four bytes
  unsigned user = 0;   // that made it
  std::string link;    // as the link of a file descriptor shows it: "socket:[12345]"
  bool is_ipv6 = false;
};

// Unreadable lines are left out; without such tables the list is empty. The kernel gives a table in parts and passes over
// sockets if others are closed in between: 481 of 15,767 readings beside a process that closed sockets all the time missed
// one that was there. So one reading proves that a socket is there, and not that it is not.
std::vector<UdpSocket> udp_sockets(const std::filesystem::path& proc = "/proc");

// The ports that they are bound to.
std::set<std::uint16_t> bound_udp_ports();

}  // namespace culprit::rtps
