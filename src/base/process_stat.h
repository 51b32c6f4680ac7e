// The kernel's statistics of one process of this machine (proc_pid_stat(5)).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace culprit {

struct ProcessStat {
  char state = 0;                // 'R': running, 'T': stopped, 'Z': a zombie …
  double processor_seconds = 0;  // that it has used, of all its threads
  std::uint64_t threads = 0;
  double started_after_boot = 0;  // seconds
  std::uint64_t virtual_bytes = 0;
  std::uint64_t resident_bytes = 0;
};

// `process`: its number, or "self". Nothing: there is no such process.
std::optional<ProcessStat> process_stat(const std::string& process);

}  // namespace culprit
