// How often a client may ask: a bucket of tokens for each address, which fills at a steady rate.
#pragma once

#include <chrono>
#include <string>
#include <unordered_map>

#include "base/mutex.h"

namespace culprit::http {

// May be called from any thread.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  // Addresses that are remembered at a time. Beyond, all are forgotten, which only helps clients.
  static constexpr std::size_t kMostClients = 1024;

  // `per_second` requests in the long run, `burst` at once.
  RateLimit(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  // Whether `client` may ask now; counts it if so.
  bool allows(const std::string& client, Clock::time_point now);

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled;
  };
  const double per_second_;
  const double burst_;
  Mutex mutex_;
  std::unordered_map<std::string, Bucket> buckets_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::http
