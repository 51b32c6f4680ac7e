#include "rtps/newcomers.h"

#include <algorithm>
#include <cstdint>

namespace culprit::ros2 {

std::size_t Newcomers::Hash::operator()(const UdpAddress& address) const {
  std::uint64_t all = address.port;
  for (const std::uint8_t byte : address.ip) all = all << 8 | byte;
  return std::hash<std::uint64_t>()(all);
}

void Newcomers::begin(const GuidPrefix& self) {
  const MutexLock lock(mutex_);
  self_ = self;
}

bool Newcomers::is_self(const GuidPrefix& participant) const {
  const MutexLock lock(mutex_);
  return self_ == participant;
}

bool Newcomers::admits(const UdpAddress& from, Time now) {
  const MutexLock lock(mutex_);
  auto known = until_.find(from);
  if (known == until_.end()) {
    if (until_.size() >= kMostSources && later(cleared_, kEach) <= now) {
      std::erase_if(until_, [&](const auto& each) { return each.second <= now; });
      cleared_ = now;
    }
    if (until_.size() >= kMostSources) return true;
    known = until_.emplace(from, now).first;
  }
  Time& until = known->second;
  until = std::max(until, now);
  if (until > later(now, (kAtOnce - 1) * kEach)) return false;
  until = later(until, kEach);
  return true;
}

}  // namespace culprit::ros2
