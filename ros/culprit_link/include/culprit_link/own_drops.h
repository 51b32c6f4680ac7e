// Datagrams that the kernel dropped because a UDP socket of this process was full. `ss -um` shows the same number, as
// "d".
//
// A middleware hides its sockets, but not from its own process: each open file is asked whether it is one. A look takes
// some microseconds a file, however many sockets the machine has.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <linux/sock_diag.h>
#include <map>
#include <optional>
#include <sys/socket.h>
#include <system_error>
#include <utility>

namespace culprit_link {

class OwnDrops {
 public:
  // So far, by sockets that are open or were at an earlier look. Never decreases.
  std::uint64_t look() {
    const std::map<int, std::uint32_t> before = std::exchange(of_descriptor_, {});
    std::error_code error;
    const std::filesystem::path all("/proc/self/fd");
    for (std::filesystem::directory_iterator file(all, error);
         !error && file != std::filesystem::directory_iterator(); file.increment(error)) {
      const int descriptor = std::atoi(file->path().filename().c_str());
      const auto now = dropped_by(descriptor);
      if (!now) continue;
      of_descriptor_[descriptor] = *now;
      const auto known = before.find(descriptor);
      // Another socket may have the descriptor by now.
      const bool is_same = known != before.end() && known->second <= *now;
      count_ += is_same ? *now - known->second : *now;
    }
    return count_;
  }

 private:
  // Nothing: it is no UDP socket.
  static std::optional<std::uint32_t> dropped_by(int descriptor) {
    int type = 0;
    int domain = 0;
    socklen_t size = sizeof type;
    if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM)
      return std::nullopt;
    size = sizeof domain;
    if (getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) != 0 ||
        (domain != AF_INET && domain != AF_INET6))
      return std::nullopt;
    std::uint32_t memory[SK_MEMINFO_VARS] = {};
    size = sizeof memory;
    if (getsockopt(descriptor, SOL_SOCKET, SO_MEMINFO, memory, &size) != 0) return std::nullopt;
    return memory[SK_MEMINFO_DROPS];
  }

  std::map<int, std::uint32_t> of_descriptor_;
  std::uint64_t count_ = 0;
};

}  // namespace culprit_link
