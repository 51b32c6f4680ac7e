#include "ros2/receive_watch.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <netinet/in.h>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <system_error>
#include <utility>

namespace culprit::ros2 {
namespace {

// The port of this process's UDP socket; nothing for whatever else the descriptor is.
std::optional<std::uint16_t> udp_port_of(int descriptor) {
  int type = 0;
  socklen_t size = sizeof type;
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM)
    return std::nullopt;
  sockaddr_in address{};
  size = sizeof address;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      address.sin_family != AF_INET)
    return std::nullopt;
  return ntohs(address.sin_port);
}

std::vector<int> descriptors() {
  std::vector<int> all;
  std::error_code failed;
  for (std::filesystem::directory_iterator each("/proc/self/fd", failed), end;
       !failed && each != end; each.increment(failed)) {
    const std::string name = each->path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    all.push_back(descriptor);
  }
  return all;
}

}  // namespace

// The kernel stamps each datagram once; when that is, does not matter, only that they differ.
ReceiveWatch::Arrival ReceiveWatch::first_unread(int descriptor) {
  const int wanted = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &wanted, sizeof wanted);
  char byte = 0;
  iovec place{&byte, sizeof byte};
  alignas(cmsghdr) char control[128];
  msghdr message{};
  message.msg_iov = &place;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  if (recvmsg(descriptor, &message, MSG_PEEK | MSG_DONTWAIT) < 0) return {};
  for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr;
       each = CMSG_NXTHDR(&message, each)) {
    if (each->cmsg_level != SOL_SOCKET || each->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec at{};
    std::memcpy(&at, CMSG_DATA(each), sizeof at);
    return {at.tv_sec, at.tv_nsec};
  }
  return {};
}

void ReceiveWatch::opened(std::uint16_t port) {
  const MutexLock lock(mutex_);
  ports_.insert(port);
}

void ReceiveWatch::look(Time now) {
  const MutexLock lock(mutex_);
  const std::vector<Socket> before = std::exchange(sockets_, {});
  for (const int descriptor : descriptors()) {
    const auto port = udp_port_of(descriptor);
    if (!port || !ports_.contains(*port)) continue;
    Socket socket{descriptor, first_unread(descriptor), now};
    const auto same = std::find_if(before.begin(), before.end(), [&](const Socket& each) {
      return each.descriptor == descriptor && each.unread == socket.unread;
    });
    const bool hangs = same != before.end() && socket.unread != Arrival();
    if (hangs) socket.attended = same->attended;
    sockets_.push_back(socket);
  }
}

Time ReceiveWatch::attended() const {
  const MutexLock lock(mutex_);
  Time oldest = kNever;
  for (const Socket& each : sockets_) oldest = std::min(oldest, each.attended);
  return oldest;
}

}  // namespace culprit::ros2
