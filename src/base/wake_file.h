// Ends another thread's poll(): a file that is readable once somebody has called wake().
#pragma once

#include <cstdint>
#include <sys/eventfd.h>
#include <unistd.h>

namespace culprit {

class WakeFile {
 public:
  WakeFile() = default;
  WakeFile(const WakeFile&) = delete;
  WakeFile& operator=(const WakeFile&) = delete;
  ~WakeFile() { close(descriptor_); }

  int descriptor() const { return descriptor_; }
  // From any thread, and from a signal's handler.
  void wake() const {
    constexpr std::uint64_t kOne = 1;
    [[maybe_unused]] const auto written = write(descriptor_, &kOne, sizeof kOne);
  }
  // Not readable until the next wake().
  void clear() const {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto taken = read(descriptor_, &count, sizeof count);
  }

 private:
  const int descriptor_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
};

}  // namespace culprit
