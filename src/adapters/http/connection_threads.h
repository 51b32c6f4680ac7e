// The threads that serve connections: as many as there are connections, up to a limit.
//
// A page keeps one connection for as long as it is open, so a small pool would soon be used up. At
// the limit a new connection ends one that waits for its client (waiting_clients.h). If none does, and no thread is free
// within kPatience, it is refused. Where the system gives no further thread (RLIMIT_NPROC, RLIMIT_AS), or the control
// group has room for few (pids.max), it is refused at once. So connections are always taken, and none waits for the
// threads of others. A few threads are there from the beginning, so that no other part of the program can take them all.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <httplib.h>
#include <optional>
#include <thread>
#include <vector>

#include "base/mutex.h"

namespace culprit::http {

class ConnectionThreads : public httplib::TaskQueue {
 public:
  // So long after a connection found no thread for the first time, all that find none are refused.
  static constexpr std::chrono::seconds kPatience{2};

  // Ends one of the connections that are served. False: none can be ended. Called with a mutex held: it must not call back.
  using EndOne = std::function<bool()>;
  // Makes `ready` threads at once, or as many as the system gives.
  ConnectionThreads(std::size_t most, std::size_t ready, EndOne end_one);

  // Returns within kPatience, or 50 ms where earlier connections waited for so long. A connection that is refused is
  // called here, with RefusesConnections.
  void enqueue(std::function<void()> connection) override;
  void shutdown() override;

 private:
  bool grows() CULPRIT_REQUIRES(mutex_);
  bool add_thread() CULPRIT_REQUIRES(mutex_);
  void serve();

  const std::size_t most_;
  const EndOne end_one_;
  Mutex mutex_;
  ConditionVariable something_changed_;
  std::deque<std::function<void()>> waiting_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::thread> threads_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t idle_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::optional<std::chrono::steady_clock::time_point> busy_since_ CULPRIT_GUARDED_BY(mutex_);
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
};

}  // namespace culprit::http
