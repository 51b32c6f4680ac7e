#include "link/process_usage.h"

#include <string>

#include "base/process_stat.h"

namespace culprit::link {

std::optional<ProcessUsage> usage_of(int pid) {
  const auto stat = process_stat(std::to_string(pid));
  if (!stat) return std::nullopt;
  constexpr double kMib = 1024.0 * 1024.0;
  return ProcessUsage{stat->processor, static_cast<double>(stat->resident_bytes) / kMib};
}

std::optional<double> UsageMeter::look(int pid, const ProcessUsage& usage, Time now) {
  constexpr Duration kLongest = std::chrono::hours(24);
  constexpr Duration kShortest = std::chrono::milliseconds(500);
  const Duration used = usage.processor - processor_;
  const Duration since = at_ == kLongAgo ? Duration::zero() : now - at_;
  const bool is_first =
      pid != pid_ || since <= Duration::zero() || since > kLongest || used < Duration::zero();
  if (!is_first && since < kShortest) return std::nullopt;
  pid_ = pid;
  processor_ = usage.processor;
  at_ = now;
  if (is_first) return std::nullopt;
  return seconds(used) / seconds(since);
}

}  // namespace culprit::link
