#include "live/host_claim.h"

#include <cerrno>
#include <signal.h>
#include <unistd.h>

namespace culprit::live {
namespace {

using Holder = ros2::NamedLock::Holder;

bool is_there(const Holder& holder) {
  return holder.pid > 0 && (kill(holder.pid, 0) == 0 || errno == EPERM);
}

std::string described(const Holder& holder) { return "process " + std::to_string(holder.pid); }

}  // namespace

std::string HostClaim::name_for(std::uint32_t user) const {
  return "culprit-" + std::to_string(user) + "-" + name_;
}

bool HostClaim::look() {
  stranger_.clear();
  holder_.clear();
  const std::uint32_t self = geteuid();
  if (self != 0) {
    const auto roots = ros2::NamedLock::holder(name_for(0));
    if (roots && roots->user == 0) {
      holder_ = described(*roots) + " of root";
      holder_pid_ = roots->pid;
      lock_.reset();
      return false;
    }
  }
  if (lock_) {
    lock_->admit();
    return true;
  }
  auto taken = ros2::NamedLock::take(name_for(self));
  if (taken && *taken) {
    lock_ = std::move(*taken);
    known_.reset();
    return true;
  }
  // Asked once only: a process that is stopped does not answer often.
  if (!known_ || !is_there(*known_)) known_ = ros2::NamedLock::holder(name_for(self));
  if (known_ && (known_->user == self || known_->user == 0)) {
    holder_ = described(*known_);
    holder_pid_ = known_->pid;
    return false;
  }
  stranger_ = known_ ? described(*known_) + " of user " + std::to_string(known_->user)
                     : "a process that does not identify itself";
  return true;
}

}  // namespace culprit::live
