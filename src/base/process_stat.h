// The kernel's statistics of one process of this machine (proc_pid_stat(5)).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/time.h"

namespace culprit {

struct ProcessStat {
  char state = 0;  // 'R': running, 'T': stopped, 'Z': a zombie …
  int parent = 0;
  int group = 0;
  int session = 0;
  int terminal = 0;         // of its session; 0: none
  int foreground = 0;       // the process group that the terminal's input goes to; -1: none
  bool is_exiting = false;  // the kernel takes it apart; its children may be another's already
  Duration processor{};     // that it has used, of all its threads
  std::uint64_t threads = 0;
  std::int64_t start_ticks = 0;   // when it began, in ticks of the kernel after boot
  double started_after_boot = 0;  // the same in seconds
  std::uint64_t virtual_bytes = 0;
  std::uint64_t resident_bytes = 0;
  int exit_status = 0;  // of a zombie, as in wait(2)
};

// `process`: its number, "self", or a thread of it ("12/task/13"). Nothing: there is no such process.
std::optional<ProcessStat> process_stat(const std::string& process);

}  // namespace culprit
