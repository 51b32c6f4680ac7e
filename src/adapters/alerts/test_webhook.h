// For tests: a server on loopback that takes webhooks, over HTTP or HTTPS, and can be set to
// misbehave.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"

namespace culprit::test {

class TestWebhook {
 public:
  // Answers with what `status` gives for each request.
  explicit TestWebhook(std::function<int()> status = [] { return 200; });
  // Over HTTPS, with a certificate that signs itself, made by openssl in `folder`: certificate().
  TestWebhook(
      const std::filesystem::path& folder, std::function<int()> status = [] { return 200; });
  ~TestWebhook();

  // "http://127.0.0.1:1234"
  std::string address() const;
  std::string certificate() const { return certificate_; }

  struct Request {
    std::string path;
    std::string body;
  };
  std::vector<Request> requests() const;
  // Waits until so many came, or long enough.
  bool waits_for(std::size_t count) const;

 private:
  class Http;
  void listen();

  std::function<int()> status_;
  std::string certificate_;
  mutable Mutex mutex_;
  mutable ConditionVariable something_came_;
  std::vector<Request> requests_ CULPRIT_GUARDED_BY(mutex_);
  std::unique_ptr<Http> http_;
  std::thread thread_;
};

// A listening socket, whose test decides what it does with each client: it calls `talk` with each
// connection.
class TestListener {
 public:
  explicit TestListener(std::function<void(int connection)> talk);
  ~TestListener();
  std::string address() const;

 private:
  int socket_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace culprit::test
