// For tests: sockets, and processes that hold them.
#pragma once

#include <arpa/inet.h>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rtps/datagram_sources.h"

namespace culprit::rtps {

inline constexpr Ip kLoopback = {127, 0, 0, 1};

// A UDP socket, on a port that the system chose if it is 0.
class TestSocket {
 public:
  enum class Port : std::uint8_t { kOwn, kShared };

  explicit TestSocket(const Ip& ip = kLoopback, Port port = Port::kOwn, std::uint16_t number = 0)
      : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const int shares = port == Port::kShared ? 1 : 0;
    setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &shares, sizeof shares);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(number);
    std::memcpy(&to.sin_addr, ip.data(), ip.size());
    socklen_t size = sizeof to;
    bind(fd_, reinterpret_cast<const sockaddr*>(&to), size);
    getsockname(fd_, reinterpret_cast<sockaddr*>(&to), &size);
    address_ = {ip, ntohs(to.sin_port)};
  }
  ~TestSocket() { close(fd_); }
  const UdpAddress& address() const { return address_; }
  int descriptor() const { return fd_; }

 private:
  int fd_;
  UdpAddress address_;
};

// fork(2), or the end of the test: kill(-1, SIGKILL) would end all processes of this user.
inline pid_t fork_or_abort() {
  const pid_t pid = fork();
  if (pid < 0) std::abort();
  return pid;
}

// A process that was forked from this one and waits, with none of its files but these.
class TestFork {
 public:
  explicit TestFork(int kept, int second = -1) : pid_(fork_or_abort()) {
    if (pid_ != 0) return;
    const int moved = second < 0 ? -1 : fcntl(second, F_DUPFD, 1000);
    dup2(kept, 0);
    if (moved >= 0) dup2(moved, 1);
    closefrom(moved >= 0 ? 2 : 1);
    for (;;) pause();
  }
  ~TestFork() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  int pid() const { return pid_; }

 private:
  int pid_;
};

}  // namespace culprit::rtps
