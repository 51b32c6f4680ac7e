// For tests: what a stranger does to the page's port.
#pragma once

#include <cstdint>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace culprit::cli {

// Connections to a port of this machine.
class Connections {
 public:
  explicit Connections(int port) : port_(port) {}
  ~Connections() {
    for (const int each : sockets_) close(each);
  }
  Connections(const Connections&) = delete;

  void open(int count) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port_));
    for (int i = 0; i < count; ++i) {
      const int each = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
      connect(each, reinterpret_cast<sockaddr*>(&to), sizeof to);
      sockets_.push_back(each);
    }
  }
  void say(const std::string& text) const {
    for (const int each : sockets_) send(each, text.data(), text.size(), MSG_NOSIGNAL);
  }

 private:
  const int port_;
  std::vector<int> sockets_;
};

}  // namespace culprit::cli
