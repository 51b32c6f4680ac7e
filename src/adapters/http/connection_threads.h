// The threads that serve connections: as many as there are connections, up to a limit.
//
// A page keeps one connection for as long as it is open, so a small pool would soon be used up. At
// the limit a new connection ends one that waits for its client (waiting_clients.h). If none does, the server takes no
// further connection until one ends: the kernel keeps some waiting and refuses the rest. Where the system gives no further
// thread (RLIMIT_NPROC, RLIMIT_AS), or the control group has room for few (pids.max), it is the same; but if none waits for
// its client, the new connection is closed unread. A few threads are there from the beginning, so that no other
// part of the program can take them all.
#pragma once

#include <deque>
#include <functional>
#include <httplib.h>
#include <thread>
#include <vector>

#include "base/mutex.h"

namespace culprit::web {

class ConnectionThreads : public httplib::TaskQueue {
 public:
  // Ends one of the connections that are served. False: none can be ended. Called with a mutex held: it must not call back.
  using EndOne = std::function<bool()>;
  // Makes `ready` threads at once, or as many as the system gives.
  ConnectionThreads(std::size_t most, std::size_t ready, EndOne end_one);

  // Blocks while all threads are busy.
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
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
};

}  // namespace culprit::web
