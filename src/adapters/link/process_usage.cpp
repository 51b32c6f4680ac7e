#include "link/process_usage.h"

#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace culprit::ros2 {

std::optional<ProcessUsage> usage_of(int pid) {
  const std::string folder = "/proc/" + std::to_string(pid);
  std::ifstream stat(folder + "/stat");
  std::string line;
  if (!std::getline(stat, line)) return std::nullopt;
  // Its name may have blanks and parentheses in it.
  const auto name_end = line.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name_end + 1));
  std::string state;
  fields >> state;
  constexpr int kBetween = 10;  // ppid to cmajflt
  std::int64_t skipped = 0;
  for (int i = 0; i < kBetween; ++i) fields >> skipped;
  std::int64_t in_user = 0;
  std::int64_t in_system = 0;
  if (!(fields >> in_user >> in_system)) return std::nullopt;
  std::ifstream memory(folder + "/statm");
  std::int64_t total = 0;
  std::int64_t resident = 0;
  if (!(memory >> total >> resident)) return std::nullopt;
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  constexpr double kMib = 1024.0 * 1024.0;
  return ProcessUsage{from_seconds(static_cast<double>(in_user + in_system) / ticks),
                      static_cast<double>(resident) * page / kMib};
}

std::optional<double> UsageMeter::look(int pid, const ProcessUsage& usage, Time now) {
  constexpr Duration kLongest = std::chrono::hours(24);
  const Duration used = usage.processor - processor_;
  const Duration since = at_ == kLongAgo ? Duration::zero() : now - at_;
  const bool is_first =
      pid != pid_ || since <= Duration::zero() || since > kLongest || used < Duration::zero();
  pid_ = pid;
  processor_ = usage.processor;
  at_ = now;
  if (is_first) return std::nullopt;
  return seconds(used) / seconds(since);
}

}  // namespace culprit::ros2
