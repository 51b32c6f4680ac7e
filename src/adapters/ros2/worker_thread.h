// A thread that does one task after the other, in the order in which they came: for tasks that may
// block, so that the caller goes on.
//
//     WorkerThread worker(8);
//     if (!worker.put([answer] { answer(ask_the_disk()); })) refuse("too much waits");
//
// Tasks must not throw. Tasks that still wait when this ends are dropped; the running task is
// finished first.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <thread>

#include "base/mutex.h"

namespace culprit::ros2 {

class WorkerThread {
 public:
  // At most so many tasks wait, not counting the one that is being done.
  explicit WorkerThread(std::size_t most_waiting);
  ~WorkerThread();
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;

  // From any thread. False: too much waits, and this does not.
  bool put(std::function<void()> task);

 private:
  void work();

  const std::size_t most_waiting_;
  Mutex mutex_;
  ConditionVariable something_came_;
  std::deque<std::function<void()>> tasks_ CULPRIT_GUARDED_BY(mutex_);
  bool is_over_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: it begins when all is there
};

}  // namespace culprit::ros2
