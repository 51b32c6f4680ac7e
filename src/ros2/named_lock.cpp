#include "ros2/named_lock.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace culprit::ros2 {

Expected<std::optional<NamedLock>> NamedLock::take(const std::string& name) {
  // Close-on-exec: a child that outlives us must not keep the name.
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return Error{std::string("no Unix socket for a lock: ") + std::strerror(errno)};
  NamedLock lock(fd);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t length = std::min<std::size_t>(name.size(), 100);
  name.copy(address.sun_path + 1, length);  // a leading NUL makes it abstract
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0)
    return std::optional(std::move(lock));
  if (errno == EADDRINUSE) return std::optional<NamedLock>();
  return Error{"cannot lock '" + name + "': " + std::strerror(errno)};
}

NamedLock::NamedLock(NamedLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

NamedLock& NamedLock::operator=(NamedLock&& other) noexcept {
  std::swap(socket_, other.socket_);
  return *this;
}

NamedLock::~NamedLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace culprit::ros2
