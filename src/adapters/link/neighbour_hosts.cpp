#include "link/neighbour_hosts.h"

#include <algorithm>

#include "rtps/own_addresses.h"

namespace culprit::link {

bool is_on_this_machine(const ros2::ParticipantInfo& info) {
  const auto own = rtps::own_addresses();
  return !info.metatraffic.empty() &&
         std::all_of(info.metatraffic.begin(), info.metatraffic.end(),
                     [&](const rtps::UdpAddress& address) { return own.contains(address.ip); });
}

void NeighbourHosts::joined(const rtps::GuidPrefix& participant, const std::string& host,
                            bool is_here) {
  if (is_here || host.empty()) return;
  const MutexLock lock(mutex_);
  if (hosts_.size() >= kMostHosts && !hosts_.contains(host))
    std::erase_if(hosts_, [](const auto& each) { return each.second.there.empty(); });
  const bool has_room =
      host_of_.size() < kMostParticipants && (hosts_.size() < kMostHosts || hosts_.contains(host));
  if (!has_room || !host_of_.emplace(participant, host).second) return;
  Host& joined = hosts_[host];
  // A new participant proves that it is reachable, so the lost ones exited by themselves.
  joined.lost = 0;
  joined.there.insert(participant);
}

void NeighbourHosts::left(const rtps::GuidPrefix& participant, bool was_lost, Time now) {
  const MutexLock lock(mutex_);
  const auto found = host_of_.find(participant);
  if (found == host_of_.end()) return;
  const auto host = hosts_.find(found->second);
  host_of_.erase(found);
  host->second.there.erase(participant);
  // Where others went on, it went by itself.
  if (was_lost && later(heard(host->second), kPatience) <= now) {
    ++host->second.lost;
  } else if (host->second.there.empty() && host->second.lost == 0) {
    hosts_.erase(host);
  }
}

void NeighbourHosts::listens_from(Time now) {
  const MutexLock lock(mutex_);
  listens_from_ = now;
}

Time NeighbourHosts::heard(const Host& host) const {
  Time last = kLongAgo;
  for (const rtps::GuidPrefix& each : host.there) last = std::max(last, heard_last_(each));
  return last;
}

bool NeighbourHosts::is_silent(const std::string& host, Time now) const {
  const MutexLock lock(mutex_);
  const auto found = hosts_.find(host);
  if (found == hosts_.end() || found->second.there.size() + found->second.lost < 2) return false;
  return later(std::max(heard(found->second), listens_from_), kPatience) <= now;
}

Time NeighbourHosts::heard(const std::string& host) const {
  const MutexLock lock(mutex_);
  const auto found = hosts_.find(host);
  if (found == hosts_.end() || found->second.there.size() + found->second.lost < 2) return kNever;
  return heard(found->second);
}

}  // namespace culprit::link
