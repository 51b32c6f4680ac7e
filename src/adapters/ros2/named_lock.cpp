#include "ros2/named_lock.h"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace culprit::ros2 {
namespace {

struct Address {
  sockaddr_un name{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&name); }
};

std::string shortened(const std::string& name) {
  constexpr std::size_t kLongest = 100;
  if (name.size() <= kLongest) return name;
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return name.substr(0, kLongest - 21) + "-" + std::to_string(hash);
}

Address address_of(const std::string& name) {
  const std::string path = shortened(name);
  Address address;
  address.name.sun_family = AF_UNIX;
  path.copy(address.name.sun_path + 1, path.size());  // a leading NUL makes it abstract
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + path.size());
  return address;
}

// Close-on-exec: a child that outlives us must not keep the name.
int open_socket() { return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

}  // namespace

Expected<std::optional<NamedLock>> NamedLock::take(const std::string& name) {
  constexpr int kWaiting = 64;  // requests for the holder between two calls of admit()
  const int fd = open_socket();
  if (fd < 0) return Error{std::string("no Unix socket for a lock: ") + std::strerror(errno)};
  NamedLock lock(fd);
  const Address address = address_of(name);
  if (bind(fd, address.get(), address.size) == 0 && listen(fd, kWaiting) == 0)
    return std::optional(std::move(lock));
  if (errno == EADDRINUSE) return std::optional<NamedLock>();
  return Error{"cannot lock '" + name + "': " + std::strerror(errno)};
}

std::optional<NamedLock::Holder> NamedLock::holder(const std::string& name) {
  const NamedLock asking(open_socket());
  const Address address = address_of(name);
  ucred credentials{};
  socklen_t size = sizeof credentials;
  const bool is_told =
      asking.socket_ >= 0 && connect(asking.socket_, address.get(), address.size) == 0 &&
      getsockopt(asking.socket_, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0;
  if (!is_told) return std::nullopt;
  return Holder{credentials.pid, credentials.uid};
}

void NamedLock::admit() {
  for (int fd = 0; (fd = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) close(fd);
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
