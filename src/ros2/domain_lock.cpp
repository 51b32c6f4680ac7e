#include "ros2/domain_lock.h"

#include <cstddef>
#include <cstring>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace culprit::ros2 {

Expected<DomainLock> DomainLock::reserve(std::uint32_t first, std::uint32_t last) {
  // Close-on-exec: a child that outlives us must not keep the domain.
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0)
    return Error{std::string("no Unix socket to lock a DDS domain with: ") + std::strerror(errno)};
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    const std::string name = "culprit-domain-" + std::to_string(domain);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, name.size());  // a leading NUL makes it abstract
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0)
      return DomainLock(fd, domain);
  }
  close(fd);
  return Error{"all DDS domains from " + std::to_string(first) + " to " + std::to_string(last) +
               " are reserved by other culprit processes"};
}

DomainLock::DomainLock(DomainLock&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), domain_(other.domain_) {}

DomainLock& DomainLock::operator=(DomainLock&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(domain_, other.domain_);
  return *this;
}

DomainLock::~DomainLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace culprit::ros2
