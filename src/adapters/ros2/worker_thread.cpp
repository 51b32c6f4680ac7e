#include "ros2/worker_thread.h"

#include <utility>

namespace culprit::ros2 {

WorkerThread::WorkerThread(std::size_t most_waiting)
    : most_waiting_(most_waiting), thread_([this] { work(); }) {}

WorkerThread::~WorkerThread() {
  {
    const MutexLock lock(mutex_);
    is_over_ = true;
    something_came_.notify_all();
  }
  thread_.join();
}

bool WorkerThread::put(std::function<void()> task) {
  const MutexLock lock(mutex_);
  if (tasks_.size() >= most_waiting_) return false;
  tasks_.push_back(std::move(task));
  something_came_.notify_all();
  return true;
}

void WorkerThread::work() {
  while (true) {
    std::function<void()> task;
    {
      MutexLock lock(mutex_);
      something_came_.wait(
          lock, [this]() CULPRIT_REQUIRES(mutex_) { return is_over_ || !tasks_.empty(); });
      if (is_over_) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }
}

}  // namespace culprit::ros2
