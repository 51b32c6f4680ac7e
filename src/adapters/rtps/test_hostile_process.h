// For tests: a process of its own that sends datagrams in the name of others, again and again.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "rtps/datagram_sources.h"
#include "rtps/test_datagram.h"

namespace culprit::ros2 {

// A stranger's lies that remove a participant: its endpoints have ended, it holds no node, and it has left.
// `info_writer` writes its ros_discovery_info; `no_nodes` is that as a payload. Reliable
// readers take a number only if it is the next one, so some after it are tried, too.
inline std::vector<Bytes> farewells(const Guid& participant, const std::vector<Guid>& endpoints,
                                    const Guid& info_writer, const Bytes& no_nodes) {
  const auto builtin = [&](std::uint8_t kind, std::uint8_t number) {
    Guid guid = participant;
    guid.bytes[12] = 0, guid.bytes[13] = kind, guid.bytes[14] = number, guid.bytes[15] = 0xc2;
    return guid;
  };
  const GuidPrefix name = participant.prefix();
  std::vector<Bytes> all;
  for (const Guid& each : endpoints) {
    const auto announced = std::ranges::count_if(
        endpoints, [&](const Guid& other) { return other.is_reader() == each.is_reader(); });
    for (std::int64_t i = announced + 1; i <= announced + 4; ++i)
      all.push_back(TestDatagram(name)
                        .farewell(each.is_reader() ? builtin(0, 4) : builtin(0, 3), i, each)
                        .bytes());
  }
  for (std::int64_t i = 2; i < 40; ++i)
    all.push_back(TestDatagram(name).sample(info_writer, i, no_nodes).bytes());
  all.push_back(TestDatagram(name).farewell(builtin(1, 0), 1000, participant).bytes());
  return all;
}

class HostileProcess {
 public:
  // It sends all to each address, and then waits for `pause`.
  HostileProcess(const std::vector<Bytes>& datagrams, const std::vector<UdpAddress>& to,
                 std::chrono::milliseconds pause)
      : pid_(fork()) {
    if (pid_ == 0) attack(datagrams, to, pause);
  }
  ~HostileProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  HostileProcess(const HostileProcess&) = delete;
  HostileProcess& operator=(const HostileProcess&) = delete;

 private:
  // After a fork of a process with threads: system calls only.
  [[noreturn]] static void attack(const std::vector<Bytes>& datagrams,
                                  const std::vector<UdpAddress>& to,
                                  std::chrono::milliseconds pause) {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    const timespec rest{pause.count() / 1000, pause.count() % 1000 * 1'000'000};
    for (;;) {
      for (const Bytes& each : datagrams) {
        for (const UdpAddress& address : to) {
          sockaddr_in there{};
          there.sin_family = AF_INET;
          std::memcpy(&there.sin_addr, address.ip.data(), address.ip.size());
          there.sin_port = htons(address.port);
          sendto(descriptor, each.data(), each.size(), 0, reinterpret_cast<sockaddr*>(&there),
                 sizeof there);
        }
      }
      nanosleep(&rest, nullptr);
    }
  }

  pid_t pid_;
};

}  // namespace culprit::ros2
