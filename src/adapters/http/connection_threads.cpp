#include "http/connection_threads.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "http/budgeted_server.h"
#include "http/thread_room.h"

namespace culprit::http {

namespace {

using Clock = std::chrono::steady_clock;

// A node that is started again has threads, too: readers of a page must not take their room.
bool leaves_room_for_nodes() {
  constexpr std::size_t kThreads = 64;
  return threads_left().value_or(kThreads) >= kThreads;
}

}  // namespace

ConnectionThreads::ConnectionThreads(std::size_t most, std::size_t ready, EndOne end_one)
    : most_(most), end_one_(std::move(end_one)) {
  const MutexLock lock(mutex_);
  while (threads_.size() < std::min(most, ready) && add_thread()) continue;
}

void ConnectionThreads::enqueue(std::function<void()> connection) {
  constexpr std::chrono::milliseconds kLooks{50};  // whether one waits for its client by now
  MutexLock lock(mutex_);
  const auto has_turn = [&]() CULPRIT_REQUIRES(mutex_) {
    return is_ending_ || waiting_.size() < idle_;
  };
  const auto came = Clock::now();
  while (!has_turn() && !grows()) {
    if (!busy_since_) busy_since_ = came;
    const bool has_waited = Clock::now() >= std::max(*busy_since_ + kPatience, came + kLooks) ||
                            threads_.size() < most_;  // the system gives no thread
    if (!end_one_() && has_waited) {
      lock.unlock();
      const RefusesConnections refuses;
      return connection();
    }
    something_changed_.wait_for(lock, kLooks, has_turn);
  }
  waiting_.push_back(std::move(connection));
  something_changed_.notify_all();
}

// Whether there is a thread more than before.
bool ConnectionThreads::grows() {
  return threads_.size() < most_ && leaves_room_for_nodes() && add_thread();
}

bool ConnectionThreads::add_thread() {
  try {
    threads_.emplace_back([this] { serve(); });
    return true;
  } catch (const std::exception&) {  // std::system_error, or no memory
    return false;
  }
}

void ConnectionThreads::serve() {
  MutexLock lock(mutex_);
  while (true) {
    ++idle_;
    busy_since_.reset();
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

}  // namespace culprit::http
