#include "live/service_manager.h"

#include <charconv>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/environment.h"

namespace culprit::live {
namespace {

std::optional<std::int64_t> number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && value > 0 ? std::optional(value) : std::nullopt;
}

// Another process of the service may be meant.
std::optional<Duration> watchdog() {
  const std::string pid = environment("WATCHDOG_PID");
  if (!pid.empty() && number(pid) != std::int64_t{getpid()}) return std::nullopt;
  const auto microseconds = number(environment("WATCHDOG_USEC"));
  if (!microseconds) return std::nullopt;
  return std::chrono::microseconds(*microseconds);
}

}  // namespace

ServiceManager::ServiceManager() : address_(environment("NOTIFY_SOCKET")) {
  const bool is_known = address_.starts_with('/') || address_.starts_with('@');
  if (!is_known || address_.size() >= sizeof(sockaddr_un::sun_path)) return;
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) return;
  period_ = watchdog();
  if (period_) next_ = kLongAgo;
}

ServiceManager::~ServiceManager() {
  if (socket_ >= 0) close(socket_);
}

void ServiceManager::ready(const std::string& status) const { tell("READY=1\nSTATUS=" + status); }

void ServiceManager::stopping() const { tell("STOPPING=1"); }

void ServiceManager::feed(Time now) {
  if (now < next_) return;
  tell("WATCHDOG=1");
  next_ = later(now, *period_ / 2);
}

void ServiceManager::tell(const std::string& state) const {
  if (socket_ < 0) return;
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, address_.data(), address_.size());
  if (address_.front() == '@') to.sun_path[0] = '\0';  // the abstract name space
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  // A service manager that does not listen is no reason to stop.
  [[maybe_unused]] const auto sent = sendto(socket_, state.data(), state.size(), MSG_NOSIGNAL,
                                            reinterpret_cast<const sockaddr*>(&to), length);
}

}  // namespace culprit::live
