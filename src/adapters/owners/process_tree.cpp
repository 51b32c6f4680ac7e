#include "owners/process_tree.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

#include "base/invariant.h"
#include "base/live_clock.h"
#include "owners/mark.h"
#include "owners/proc.h"

namespace culprit::owners {

void send_signal(const FileDescriptor& process, int signal) {
  CULPRIT_ASSERT(process);
  syscall(SYS_pidfd_send_signal, process.get(), signal, nullptr, 0);
}

FileDescriptor hold(int pid, std::int64_t start_ticks) {
  FileDescriptor held(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  if (held && start_ticks_of(pid) == start_ticks) return held;
  return {};
}

std::vector<FileDescriptor> signal_descendants(int pid, const std::string& variable, int signal) {
  CULPRIT_ASSERT(pid > 1);            // all processes are below the first one
  CULPRIT_ASSERT(!variable.empty());  // which shows the processes that are another's
  std::vector<FileDescriptor> tree;
  const std::vector<int> group = members_of_group(pid);
  for (const Relative& each : descendants_of(pid)) {
    FileDescriptor held = hold(each.pid, each.start_ticks);
    if (!held || is_anothers(each.pid, variable)) continue;
    if (std::ranges::find(group, each.pid) == group.end()) send_signal(held, signal);
    tree.push_back(std::move(held));
  }
  return tree;
}

void kill_left(const std::string& mark, const std::string& variable, Duration patience) {
  CULPRIT_ASSERT(!mark.empty());
  constexpr int kRounds = 5;
  const Time end = later(live_now(), patience);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<FileDescriptor> killed;
    for (const int pid : left_by(mark, variable)) {
      FileDescriptor held(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
      // Its number may be another process's by now.
      if (!held || !carries_mark(pid, mark) || is_what_was_launched(pid)) continue;
      send_signal(held, SIGKILL);
      killed.push_back(std::move(held));
    }
    if (killed.empty()) return;
    for (const FileDescriptor& each : killed) {
      pollfd ended{each.get(), POLLIN, 0};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - live_now()).count();
      poll(&ended, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
    }
  }
}

}  // namespace culprit::owners
