#include "owners/watched_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/invariant.h"
#include "base/tracer.h"
#include "owners/mark.h"
#include "owners/proc.h"

namespace culprit::owners {

Expected<WatchedProcess> WatchedProcess::watch(int pid, Relation relation) {
  const auto fd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (fd < 0)
    return Error{"cannot watch process " + std::to_string(pid) + ": " + std::strerror(errno)};
  return WatchedProcess(pid, FileDescriptor(fd), relation);
}

WatchedProcess::WatchedProcess(int pid, FileDescriptor pidfd, Relation relation)
    : pid_(pid),
      pidfd_(std::move(pidfd)),
      freezer_(pid),
      relation_(relation),
      mark_(relation == Relation::kMarked ? variable_of(pid) : "") {}

ProcessState WatchedProcess::state() const {
  pollfd ended{pidfd_.get(), POLLIN, 0};
  if (poll(&ended, 1, 0) > 0) return ProcessState::kGone;
  // 'Z' is a main thread that has ended before the others: the process goes on.
  const char letter = state_letter(pid_).value_or('X');
  const bool stands = letter == 'T' || letter == 't';
  if (stands && !is_traced(pid_)) return ProcessState::kStopped;
  return is_frozen() ? ProcessState::kStopped : ProcessState::kRunning;
}

void WatchedProcess::signal(int number) const {
  CULPRIT_ASSERT(!is_reaped_);  // as kill_group()
  if (relation_ == Relation::kAdopted) {
    syscall(SYS_pidfd_send_signal, pidfd_.get(), number, nullptr, 0);
  } else {
    signal_group(number);
  }
}

// A child's number is its own until we reap it, and so is its group's. Other processes are held and
// checked one by one: a group of this number may be somebody else's by now.
void WatchedProcess::signal_group(int number) const {
  CULPRIT_ASSERT(pid_ > 1);  // group 1 would be all processes
  if (relation_ == Relation::kChild) {
    // It may not lead its group yet.
    if (kill(-pid_, number) != 0) syscall(SYS_pidfd_send_signal, pidfd_.get(), number, nullptr, 0);
    return;
  }
  for (const int each : members_of_group(pid_)) {
    const FileDescriptor held(static_cast<int>(syscall(SYS_pidfd_open, each, 0)));
    if (held && has_variable(each, mark_))
      syscall(SYS_pidfd_send_signal, held.get(), number, nullptr, 0);
  }
}

ProcessEnd WatchedProcess::reap() {
  CULPRIT_ASSERT(state() == ProcessState::kGone);
  if (relation_ != Relation::kChild) return end_of(pid_, pidfd_.get());
  is_reaped_ = true;
  siginfo_t info{};
  if (waitid(static_cast<idtype_t>(P_PIDFD), static_cast<id_t>(pidfd_.get()), &info, WEXITED) != 0)
    return end_of(pid_, pidfd_.get());
  return info.si_code == CLD_EXITED ? exited(info.si_status) : killed(info.si_status);
}

void WatchedProcess::kill_group() const {
  CULPRIT_ASSERT(!is_reaped_);  // the number may be another group's by now
  if (relation_ != Relation::kAdopted) signal_group(SIGKILL);
}

}  // namespace culprit::owners
