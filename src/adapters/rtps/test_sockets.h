// For tests: sockets, and processes that hold them.
#pragma once

#include <arpa/inet.h>
#include <csignal>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rtps/datagram_sources.h"

namespace culprit::ros2 {

inline constexpr Ip kLoopback = {127, 0, 0, 1};

// A UDP socket on a port that the system chose.
class TestSocket {
 public:
  explicit TestSocket(const Ip& ip = kLoopback) : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
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

// A process that was forked from this one and waits, with none of its files but one.
class TestFork {
 public:
  explicit TestFork(int kept) : pid_(fork()) {
    if (pid_ != 0) return;
    dup2(kept, 0);
    closefrom(1);
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

}  // namespace culprit::ros2
