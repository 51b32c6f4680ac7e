#include "rtps/newcomers.h"

#include <algorithm>
#include <cstdint>

namespace culprit::rtps {

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
  const bool is_elsewhere = from.ip[0] != 127;
  const MutexLock lock(mutex_);
  Time* const computer = is_elsewhere ? computers_.find({from.ip, 0}, now) : nullptr;
  if (!computers_.has_room(computer, now)) return false;
  Time* const socket = sockets_.find(from, now);
  if (!sockets_.has_room(socket, now)) return false;
  computers_.note(computer, now);
  sockets_.note(socket, now);
  return true;
}

Time* Newcomers::Sources::find(const UdpAddress& source, Time now) {
  const auto known = until_.find(source);
  if (known != until_.end()) return &known->second;
  if (until_.size() >= kMostSources && later(cleared_, each_) <= now) {
    std::erase_if(until_, [&](const auto& each) { return each.second <= now; });
    cleared_ = now;
  }
  if (until_.size() >= kMostSources) return nullptr;
  return &until_.emplace(source, now).first->second;
}

bool Newcomers::Sources::has_room(const Time* until, Time now) const {
  return until == nullptr || *until <= later(now, (at_once_ - 1) * each_);
}

void Newcomers::Sources::note(Time* until, Time now) const {
  if (until != nullptr) *until = later(std::max(*until, now), each_);
}

}  // namespace culprit::rtps
