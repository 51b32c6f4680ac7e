// When a growing count is worth a report: at the first `least`, and then each time that it is ten times what was
// reported. So a flood of events is no flood of messages.
#pragma once

#include <algorithm>
#include <cstdint>

namespace culprit::link {

class Tenfold {
 public:
  explicit Tenfold(std::uint64_t least) : next_(least) {}

  // Whether to report this count now.
  bool is_due(std::uint64_t count) {
    if (count < next_) return false;
    constexpr std::uint64_t kLargest = UINT64_MAX / 10;
    next_ = 10 * std::min(count, kLargest);
    return true;
  }

 private:
  std::uint64_t next_;
};

}  // namespace culprit::link
