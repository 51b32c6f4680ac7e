#include "http/rate_limit.h"

#include <algorithm>

namespace culprit::http {

bool RateLimit::allows(const std::string& client, Clock::time_point now) {
  const MutexLock lock(mutex_);
  if (buckets_.size() >= kMostClients && !buckets_.contains(client)) buckets_.clear();
  Bucket& bucket = buckets_.try_emplace(client, Bucket{burst_, now}).first->second;
  const double passed = std::chrono::duration<double>(now - bucket.filled).count();
  bucket.tokens = std::min(burst_, bucket.tokens + passed * per_second_);
  bucket.filled = now;
  if (bucket.tokens < 1) return false;
  bucket.tokens -= 1;
  return true;
}

}  // namespace culprit::http
