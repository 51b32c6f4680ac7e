#include "ros2/executor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <string>
#include <sys/signalfd.h>
#include <unistd.h>

#include "base/invariant.h"

namespace culprit::ros2 {
namespace {

timespec to_timespec(std::chrono::nanoseconds d) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(d);
  return {static_cast<time_t>(whole.count()), static_cast<long>((d - whole).count())};
}

}  // namespace

Executor::~Executor() {
  CULPRIT_ASSERT(ready_.empty() && timers_.empty() && running_ == nullptr);
  if (signal_fd_ >= 0) close(signal_fd_);
}

Expected<void> Executor::stop_on(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signal_fd_ = signalfd(signal_fd_, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  if (signal_fd_ < 0) return Error{std::string("cannot wait for signals: ") + std::strerror(errno)};
  return {};
}

void Executor::run() {
  MutexLock lock(mutex_);
  thread_ = std::this_thread::get_id();
  while (!stopped_) {
    collect_due();
    if (ready_.empty()) {
      sleep(lock);
    } else {
      run_front(lock);
    }
  }
  thread_ = {};
}

void Executor::stop() {
  const MutexLock lock(mutex_);
  stopped_ = true;
  wake();
}

// A system call only when it is needed.
void Executor::wake() {
  if (!sleeping_) return;
  sleeping_ = false;
  wake_file_.wake();
}

void Executor::collect_due() {
  if (timers_.empty()) return;
  const auto now = Clock::now();
  while (!timers_.empty() && timers_.begin()->first.first <= now) {
    ready_.push_back(std::move(timers_.begin()->second));
    timers_.erase(timers_.begin());
  }
}

void Executor::run_front(MutexLock& lock) {
  {
    const Entry entry = std::move(ready_.front());
    ready_.pop_front();
    running_ = entry.owner;
    lock.unlock();
    entry.task();
  }  // what the task holds is released here, still without the lock
  // Here too, for a process that always has something to do must still be stoppable.
  const bool has_signal = take_signal();
  lock.lock();
  running_ = nullptr;
  stopped_ = stopped_ || has_signal;
  finished_.notify_all();
}

bool Executor::take_signal() const {
  signalfd_siginfo info{};
  return signal_fd_ >= 0 && read(signal_fd_, &info, sizeof info) == sizeof info;
}

void Executor::sleep(MutexLock& lock) {
  sleeping_ = true;
  timespec timeout{};
  const bool has_timeout = !timers_.empty();
  if (has_timeout) {
    timeout =
        to_timespec(std::max(timers_.begin()->first.first - Clock::now(), Clock::duration::zero()));
  }
  lock.unlock();
  std::array<pollfd, 2> fds = {pollfd{wake_file_.descriptor(), POLLIN, 0},
                               pollfd{signal_fd_, POLLIN, 0}};
  ppoll(fds.data(), fds.size(), has_timeout ? &timeout : nullptr, nullptr);  // ignores an fd of -1
  if ((fds[0].revents & POLLIN) != 0) wake_file_.clear();
  const bool has_signal = take_signal();
  lock.lock();
  sleeping_ = false;
  stopped_ = stopped_ || has_signal;
}

void TaskGroup::close() {
  MutexLock lock(executor_.mutex_);
  closed_ = true;
  std::erase_if(executor_.ready_, [this](const auto& entry) { return entry.owner == this; });
  std::erase_if(executor_.timers_,
                [this](const auto& timer) { return timer.second.owner == this; });
  if (executor_.thread_ == std::this_thread::get_id()) {
    // It may be its own task that closes it; then `running_` must not name a group that is about to
    // be gone.
    if (executor_.running_ == this) executor_.running_ = nullptr;
    return;
  }
  executor_.finished_.wait(
      lock, [this]() CULPRIT_REQUIRES(executor_.mutex_) { return executor_.running_ != this; });
}

void TaskGroup::post(Executor::Task task) {
  const MutexLock lock(executor_.mutex_);
  if (closed_) return;
  executor_.ready_.push_back({this, std::move(task)});
  executor_.wake();
}

TaskGroup::TimerId TaskGroup::post_at(Executor::Clock::time_point at, Executor::Task task) {
  const MutexLock lock(executor_.mutex_);
  const TimerId timer{at, executor_.next_number_++};
  if (closed_) return timer;
  const auto added = executor_.timers_.emplace(Executor::Due{timer.at, timer.number},
                                               Executor::Entry{this, std::move(task)});
  if (added.first == executor_.timers_.begin()) executor_.wake();
  return timer;
}

void TaskGroup::cancel(TimerId timer) {
  Executor::Task dropped;  // released without the lock
  const MutexLock lock(executor_.mutex_);
  const auto found = executor_.timers_.find(Executor::Due{timer.at, timer.number});
  if (found == executor_.timers_.end()) return;
  dropped = std::move(found->second.task);
  executor_.timers_.erase(found);
}

}  // namespace culprit::ros2
