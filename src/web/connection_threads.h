// The threads that serve connections: as many as there are connections, up to a limit.
//
// A page keeps one connection for as long as it is open, so a small pool would soon be used up. At
// the limit the server takes no further connection until one ends: the kernel keeps a few waiting
// and refuses the rest.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <httplib.h>
#include <mutex>
#include <thread>
#include <vector>

namespace culprit::web {

class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(std::size_t most) : most_(most) {}

  // Blocks while all threads are busy.
  void enqueue(std::function<void()> connection) override;
  void shutdown() override;

 private:
  void serve();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable something_changed_;
  std::deque<std::function<void()>> waiting_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0;
  bool is_ending_ = false;
};

}  // namespace culprit::web
