#include "web/process_metrics.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>

#include <fmt/core.h>

#include "base/process_stat.h"

namespace culprit::web {
namespace {

// Seconds since 1970; 0: not known.
std::uint64_t boot_time() {
  std::ifstream file("/proc/stat");
  for (std::string word; file >> word;) {
    std::uint64_t at = 0;
    if (word == "btime" && file >> at) return at;
  }
  return 0;
}

std::uint64_t open_files() {
  std::error_code error;
  std::uint64_t count = 0;
  for (auto entry = std::filesystem::directory_iterator("/proc/self/fd", error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    ++count;
  return count == 0 ? 0 : count - 1;  // the folder itself is one of them
}

void add(std::string& out, const char* name, const char* type, const char* help, double value) {
  out += fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n{0} {3}\n", name, type, help, value);
}

}  // namespace

std::string process_metrics() {
  std::string out;
  const auto stat = process_stat("self");
  if (!stat) return out;
  const auto number = [](std::uint64_t value) { return static_cast<double>(value); };
  add(out, "process_cpu_seconds_total", "counter", "User and system CPU time.",
      seconds(stat->processor));
  add(out, "process_resident_memory_bytes", "gauge", "Memory that is resident.",
      number(stat->resident_bytes));
  add(out, "process_virtual_memory_bytes", "gauge", "Virtual memory.", number(stat->virtual_bytes));
  add(out, "process_threads", "gauge", "Threads.", number(stat->threads));
  add(out, "process_open_fds", "gauge", "Open file descriptors.", number(open_files()));
  rlimit most{};
  if (getrlimit(RLIMIT_NOFILE, &most) == 0)
    add(out, "process_max_fds", "gauge", "The most file descriptors that may be open.",
        number(most.rlim_cur));
  if (const std::uint64_t boot = boot_time(); boot != 0)
    add(out, "process_start_time_seconds", "gauge", "When it was started, in seconds since 1970.",
        number(boot) + stat->started_after_boot);
  return out;
}

}  // namespace culprit::web
