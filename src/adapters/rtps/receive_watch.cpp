#include "rtps/receive_watch.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <sys/socket.h>
#include <utility>

namespace culprit::rtps {
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

void ReceiveWatch::look(std::span<const int> sockets, Time now) {
  const MutexLock lock(mutex_);
  const std::vector<Socket> before = std::exchange(sockets_, {});
  for (const int descriptor : sockets) {
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

}  // namespace culprit::rtps
