#include "http/connection_threads.h"

#include <utility>

namespace culprit::web {

void ConnectionThreads::enqueue(std::function<void()> connection) {
  MutexLock lock(mutex_);
  something_changed_.wait(lock, [&]() CULPRIT_REQUIRES(mutex_) {
    return is_ending_ || waiting_.size() < idle_ || threads_.size() < most_;
  });
  waiting_.push_back(std::move(connection));
  if (waiting_.size() > idle_ && threads_.size() < most_)
    threads_.emplace_back([this] { serve(); });
  something_changed_.notify_all();
}

void ConnectionThreads::serve() {
  MutexLock lock(mutex_);
  while (true) {
    ++idle_;
    something_changed_.notify_all();  // somebody may wait for an idle thread
    something_changed_.wait(
        lock, [&]() CULPRIT_REQUIRES(mutex_) { return is_ending_ || !waiting_.empty(); });
    --idle_;
    if (waiting_.empty()) return;
    const std::function<void()> connection = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    connection();
    lock.lock();
  }
}

void ConnectionThreads::shutdown() {
  std::vector<std::thread> threads;
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
    threads = std::exchange(threads_, {});
  }
  something_changed_.notify_all();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace culprit::web
