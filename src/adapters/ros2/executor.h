// One thread that runs the callbacks of a process, in the order in which they became due.
//
// The thread that calls run() is that thread. It sleeps until there is something to do, never
// polls, and can be stopped from any thread, any callback, or by signals.
//
// Work is handed in through a TaskGroup, which takes its unfinished work back when it is closed: so
// an object that owns its TaskGroup, and closes it first of all in its destructor, is never called
// back after its end.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <map>
#include <thread>
#include <utility>

#include "base/expected.h"
#include "base/mutex.h"
#include "base/wake_file.h"

namespace culprit::ros2 {

class TaskGroup;

class Executor {
 public:
  using Clock = std::chrono::steady_clock;
  using Task = std::function<void()>;

  Executor() = default;
  ~Executor();  // @pre not running, and no TaskGroup left
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // Blocks these signals in the calling thread and in those that it creates later, and lets each of
  // them stop run(). So call it first in main, before any thread exists.
  Expected<void> stop_on(std::initializer_list<int> signals);

  // Runs tasks until stop() was called, before or after.
  void run();

  // From any thread.
  void stop();

 private:
  friend class TaskGroup;
  using Due = std::pair<Clock::time_point, std::uint64_t>;

  struct Entry {
    const TaskGroup* owner;
    Task task;
  };

  void wake() CULPRIT_REQUIRES(mutex_);
  void collect_due() CULPRIT_REQUIRES(mutex_);
  // Both let go of the lock in between, which the analysis cannot follow.
  void run_front(MutexLock& lock) CULPRIT_REQUIRES(mutex_) CULPRIT_NOT_ANALYZED;
  void sleep(MutexLock& lock) CULPRIT_REQUIRES(mutex_) CULPRIT_NOT_ANALYZED;
  bool take_signal() const;

  WakeFile wake_file_;
  int signal_fd_ = -1;

  Mutex mutex_;
  std::deque<Entry> ready_ CULPRIT_GUARDED_BY(mutex_);
  std::map<Due, Entry> timers_ CULPRIT_GUARDED_BY(mutex_);
  std::uint64_t next_number_ CULPRIT_GUARDED_BY(mutex_) = 1;
  bool stopped_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool sleeping_ CULPRIT_GUARDED_BY(mutex_) = false;
  const TaskGroup* running_ CULPRIT_GUARDED_BY(mutex_) = nullptr;  // whose task runs now
  std::thread::id thread_ CULPRIT_GUARDED_BY(mutex_);              // that of run()
  ConditionVariable finished_;                                     // a task has
};

// Tasks of one owner on an executor. Thread-safe.
class TaskGroup {
 public:
  // Names a task that waits for its time.
  struct TimerId {
    Executor::Clock::time_point at{};
    std::uint64_t number = 0;
  };

  explicit TaskGroup(Executor& executor) : executor_(executor) {}
  ~TaskGroup() { close(); }
  TaskGroup(const TaskGroup&) = delete;
  TaskGroup& operator=(const TaskGroup&) = delete;

  void post(Executor::Task task);
  TimerId post_at(Executor::Clock::time_point at, Executor::Task task);
  // Does nothing when the task has begun.
  void cancel(TimerId timer);

  // Tasks that have not begun will never run, and new ones are dropped. One that runs right now is
  // waited for, unless this is its own thread.
  void close();

 private:
  Executor& executor_;
  bool closed_ = false;  // guarded by the executor's mutex
};

}  // namespace culprit::ros2
