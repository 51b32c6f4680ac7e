#include "process/watched_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "process/proc.h"

namespace culprit::process {

Expected<WatchedProcess> WatchedProcess::watch(int pid, Relation relation) {
  const auto fd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (fd < 0)
    return Error{"cannot watch process " + std::to_string(pid) + ": " + std::strerror(errno)};
  return WatchedProcess(pid, FileDescriptor(fd), relation, getpgid(pid) == pid);
}

ProcessState WatchedProcess::state() const {
  pollfd ended{pidfd_.get(), POLLIN, 0};
  if (poll(&ended, 1, 0) > 0) return ProcessState::kGone;
  switch (state_letter(pid_).value_or('X')) {
    case 'T':
    case 't':
      return ProcessState::kStopped;
    case 'Z':
    case 'X':
      return ProcessState::kGone;
    default:
      return ProcessState::kRunning;
  }
}

void WatchedProcess::signal(int number) const {
  if (leads_group_ && state() != ProcessState::kGone) {
    kill(-pid_, number);
  } else {
    syscall(SYS_pidfd_send_signal, pidfd_.get(), number, nullptr, 0);
  }
}

std::string WatchedProcess::reap() {
  if (relation_ == Relation::kAdopted) return "ended";
  siginfo_t info{};
  if (waitid(static_cast<idtype_t>(P_PIDFD), static_cast<id_t>(pidfd_.get()), &info, WEXITED) != 0)
    return "ended";
  if (info.si_code == CLD_EXITED) return "exit code " + std::to_string(info.si_status);
  return "killed by signal " + std::to_string(info.si_status);
}

void WatchedProcess::kill_group() const {
  if (leads_group_) kill(-pid_, SIGKILL);
}

}  // namespace culprit::process
