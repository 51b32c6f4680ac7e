#include "rtps/origins.h"

#include <algorithm>
#include <unistd.h>
#include <utility>

#include "base/invariant.h"
#include "base/live_clock.h"
#include "rtps/claims.h"
#include "rtps/process_sockets.h"
#include "rtps/speakers.h"
#include "rtps/udp_sockets.h"

namespace culprit::rtps {
namespace {

bool overlap(const Ip& one, const Ip& other) {
  return one == Ip{} || other == Ip{} || one == other;
}

// A datagram from such a socket looks the same as one from the other. A socket for IPv6 may send over IPv4, but not
// from a port that one for IPv4 has.
bool share(const UdpSocket& one, const UdpSocket& other) {
  return (one.is_ipv6 || !other.is_ipv6) && one.address.port == other.address.port &&
         overlap(one.address.ip, other.address.ip);
}

}  // namespace

bool Origins::Socket::has(const UdpAddress& from) const {
  return address.port == from.port && overlap(address.ip, from.ip);
}

Origins::Origins(std::filesystem::path proc, std::function<std::set<Ip>()> own,
                 std::function<Time()> clock)
    : proc_(std::move(proc)), own_(std::move(own)), clock_(clock ? std::move(clock) : live_now) {}

bool Origins::prove(const GuidPrefix& participant, int pid,
                    std::span<const UdpAddress> spoke_from) {
  const auto began = running_since(proc_ / std::to_string(pid));
  if (!began) return true;
  Proven proven;
  proven.pid = pid;
  proven.began = *began;
  const std::vector<UdpSocket> table = udp_sockets(proc_);
  const MutexLock lock(mutex_);
  const auto known = proven_.find(participant);
  if (known != proven_.end() && known->second.pid == pid && known->second.began == *began)
    return true;
  if (!look(proven, table, clock_())) return true;
  proven.looked = kLongAgo;  // it may just be opening sockets
  bool are_all_its = true;
  for (const UdpAddress& each : spoke_from) {
    // The search for the process covers only addresses of this machine.
    const bool is_its = find(proven, each) == Whose::kIts;
    if (is_its) own_ips_.insert(each.ip);
    are_all_its = are_all_its && is_its;
  }
  if (pid == getpid()) {
    for (const Socket& each : proven.sockets) witnesses_.insert(each.link);
  }
  if (!are_all_its) {
    proven.is_forgotten_once = true;
    doubtful_.push_back(participant);
  }
  proven_.insert_or_assign(participant, std::move(proven));
  elsewhere_.erase(participant);
  return are_all_its;
}

bool Origins::is_proven(const GuidPrefix& participant) const {
  const MutexLock lock(mutex_);
  return proven_.contains(participant);
}

std::optional<GuidPrefix> Origins::take_doubtful() {
  const MutexLock lock(mutex_);
  if (doubtful_.empty()) return std::nullopt;
  const GuidPrefix first = doubtful_.back();
  doubtful_.pop_back();
  return first;
}

void Origins::forget(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  const auto found = proven_.find(participant);
  if (found != proven_.end() && !std::exchange(found->second.is_forgotten_once, false))
    proven_.erase(found);
  elsewhere_.erase(participant);
}

void Origins::begin_to_bind(const GuidPrefix& self) {
  const MutexLock lock(mutex_);
  self_ = self;
}

void Origins::discovered(const GuidPrefix& participant, std::span<const UdpAddress> announced,
                         Time now) {
  const MutexLock lock(mutex_);
  if (!self_ || participant == *self_ || proven_.contains(participant)) return;
  if (elsewhere_.size() >= DatagramSources::kMostParticipants && !elsewhere_.contains(participant))
    return;
  Elsewhere& elsewhere = elsewhere_.try_emplace(participant, Elsewhere{.since = now}).first->second;
  for (const UdpAddress& each : announced) {
    // Each computer with containers has the address of a bridge, and it is often the same.
    if (elsewhere.announced.size() < kMostIps && !is_of_this_machine(each.ip, now))
      elsewhere.announced.insert(each.ip);
  }
}

bool Origins::counts(std::span<const std::uint8_t> datagram, const UdpAddress& from, Time now) {
  if (!is_rtps(datagram)) return true;
  const MutexLock lock(mutex_);
  bool all_count = true;
  for_each_speaker(datagram, [&](const GuidPrefix& participant) CULPRIT_REQUIRES(mutex_) {
    const auto elsewhere = elsewhere_.find(participant);
    if (elsewhere != elsewhere_.end() && !counts(elsewhere->second, datagram, from.ip, now)) {
      all_count = false;
      note({from, std::nullopt, participant, 0});
    }
    const auto found = proven_.find(participant);
    if (found == proven_.end() || whose(found->second, from, now) != Whose::kForeign) return;
    all_count = false;
    note(participant, found->second, from);
  });
  if (!all_count) ++dropped_;
  return all_count;
}

bool Origins::counts(Elsewhere& elsewhere, std::span<const std::uint8_t> datagram, const Ip& ip,
                     Time now) {
  const Ip from = is_of_this_machine(ip, now) ? Ip{127, 0, 0, 1} : ip;
  const bool is_known = elsewhere.heard.contains(from) || elsewhere.announced.contains(from);
  if (elsewhere.is_bound) {
    const Duration pause = now - elsewhere.last;
    if (is_known) {
      elsewhere.longest = std::max(elsewhere.longest, pause);
      elsewhere.last = now;
      return true;
    }
    if (pause < std::clamp(2 * elsewhere.longest, kQuiet, kLongestQuiet)) return false;
    elsewhere = {.since = now, .heard = {from}, .last = now};
    return true;
  }
  if (elsewhere.heard.size() < kMostIps) elsewhere.heard.insert(from);
  elsewhere.last = now;
  if (now < later(elsewhere.since, kAlone) || !self_ || !acknowledges(datagram, *self_))
    return true;
  elsewhere.is_bound = std::ranges::all_of(elsewhere.heard, [&](const Ip& each) {
    return each == from || elsewhere.announced.contains(each);
  });
  return true;
}

bool Origins::may_tell_of(const GuidPrefix& other, const UdpAddress& from, bool has_spoken,
                          Time now) {
  const MutexLock lock(mutex_);
  const auto found = proven_.find(other);
  if (found == proven_.end() ? has_spoken : whose(found->second, from, now) != Whose::kForeign)
    return true;
  ++dropped_;
  if (found == proven_.end()) {
    note({from, std::nullopt, other, 0});
  } else {
    note(other, found->second, from);
  }
  return false;
}

Origins::Whose Origins::whose(Proven& proven, const UdpAddress& from, Time now) {
  if (!is_of_this_machine(from.ip, now)) return Whose::kForeign;
  if (find(proven, from) == Whose::kIts) return Whose::kIts;
  const auto foreign = proven.foreign.find(from);
  if (foreign != proven.foreign.end() && now < later(foreign->second.since, kForeignFor))
    return Whose::kForeign;
  if (proven.ended)
    return now < later(*proven.ended, kAfterEnd) ? Whose::kForeign : Whose::kUnknown;
  if (now < later(proven.looked, kFresh)) return Whose::kForeign;
  if (now < next_look_) return Whose::kUnknown;
  const Time begin = clock_();
  std::vector<UdpSocket> table = udp_sockets(proc_);
  bool is_known = look(proven, table, now);
  if (is_known && find(proven, from) != Whose::kIts) {
    // The kernel may pass over a socket of a table that changes while it is read.
    table = udp_sockets(proc_);
    is_known = look(proven, table, now);
  }
  const Duration took = clock_() - begin;
  next_look_ = later(now, took * (kShareOfTime - 1));
  if (!is_known) return Whose::kUnknown;
  if (find(proven, from) == Whose::kIts) return Whose::kIts;
  const auto holder = std::ranges::find_if(table, [&](const UdpSocket& each) {
    return Socket{each.address, each.link}.has(from);
  });
  if (proven.foreign.size() >= kMostAddresses) proven.foreign.clear();
  proven.foreign[from] = {
      now, holder == table.end() ? std::nullopt : std::optional<unsigned>(holder->user)};
  return Whose::kForeign;
}

// A port that several processes share proves little. Middlewares share those for multicast only,
// and send from others.
Origins::Whose Origins::find(Proven& proven, const UdpAddress& from) {
  bool shares = false;
  for (const Socket& each : proven.sockets) {
    if (!each.has(from)) continue;
    if (each.is_shared) {
      shares = true;
      continue;
    }
    proven.spoke_alone = true;
    return Whose::kIts;
  }
  return shares && !proven.spoke_alone ? Whose::kIts : Whose::kForeign;
}

bool Origins::look(Proven& proven, const std::vector<UdpSocket>& table, Time now) {
  if (!is_of_this_network(table)) return false;
  const std::filesystem::path process = proc_ / std::to_string(proven.pid);
  const auto links = descriptors_of(process);
  const bool is_ending = links && links->empty();
  if (is_ending || running_since(process) != proven.began) return end(proven, table, now);
  if (!links) return false;
  std::vector<Socket> sockets;
  for (const UdpSocket& each : table) {
    if (!links->contains(each.link)) continue;
    const bool is_shared = std::ranges::any_of(table, [&](const UdpSocket& other) {
      return !links->contains(other.link) && share(each, other);
    });
    sockets.push_back({each.address, each.link, is_shared});
  }
  proven.sockets = std::move(sockets);
  proven.looked = now;
  return true;
}

// There is at least the socket that receives.
bool Origins::is_of_this_network(const std::vector<UdpSocket>& table) const {
  if (witnesses_.empty()) return !table.empty();
  return std::ranges::any_of(table, [&](const UdpSocket& each) CULPRIT_REQUIRES(mutex_) {
    return witnesses_.contains(each.link);
  });
}

// False: a process that it had started holds its sockets, and may go on speaking. They may also be those of
// threads that are just ending, or the table may be older than the end: for a moment, that is not decided, and
// nothing new counts.
bool Origins::end(Proven& proven, const std::vector<UdpSocket>& table, Time now) {
  if (!proven.ending) proven.ending = now;
  const bool lives_on = std::ranges::any_of(table, [&](const UdpSocket& each) {
    return std::ranges::any_of(proven.sockets,
                               [&](const Socket& its) { return its.link == each.link; });
  });
  if (lives_on && now >= later(*proven.ending, kEnds)) return false;
  proven.looked = now;
  if (lives_on) return true;
  proven.sockets.clear();
  if (!proven.ended) proven.ended = now;
  return true;
}

void Origins::check(Time now) {
  const std::vector<UdpSocket> table = udp_sockets(proc_);
  const MutexLock lock(mutex_);
  if (!is_of_this_network(table)) return;
  for (auto each = proven_.begin(); each != proven_.end();) {
    Proven& proven = each->second;
    const bool is_over = proven.ended && now >= later(*proven.ended, kAfterEnd);
    const bool has_ended =
        !proven.ended && running_since(proc_ / std::to_string(proven.pid)) != proven.began;
    if (is_over || (has_ended && !end(proven, table, now))) {
      each = proven_.erase(each);
      continue;
    }
    std::erase_if(proven.sockets, [&](const Socket& socket) {
      return std::ranges::none_of(table, [&](const UdpSocket& known) {
        return known.link == socket.link && known.address == socket.address;
      });
    });
    ++each;
  }
}

// Interfaces come and go. If the system lists none but the loopback one, the list may be
// incomplete.
bool Origins::is_of_this_machine(const Ip& ip, Time now) {
  constexpr Duration kSeldom = std::chrono::milliseconds(100);
  constexpr Duration kLasts = std::chrono::seconds(1);
  if (ip[0] == 127) return true;
  const bool is_known = own_ips_.contains(ip);
  if (now < later(asked_for_own_, is_known ? kLasts : kSeldom)) return is_known;
  asked_for_own_ = now;
  std::set<Ip> own = own_();
  if (own.size() > 1 || own_ips_.empty()) own_ips_ = std::move(own);
  return own_ips_.contains(ip);
}

void Origins::note(const GuidPrefix& participant, const Proven& proven, const UdpAddress& from) {
  ForeignSource source{from, std::nullopt, participant, proven.pid};
  if (is_of_this_machine(from.ip, asked_for_own_)) {
    const auto foreign = proven.foreign.find(from);
    if (foreign == proven.foreign.end()) return;  // it is reported once its socket was looked up
    source.user = foreign->second.user;
    // The last datagrams of a participant of this process arrive after it closed its sockets.
    if (proven.pid == getpid() && !source.user) return;
  }
  note(source);
}

void Origins::note(const ForeignSource& source) {
  const bool is_known = std::ranges::any_of(sources_, [&](const ForeignSource& each) {
    return each.from.ip == source.from.ip && each.user == source.user;
  });
  if (!is_known && sources_.size() < kMostSources) sources_.push_back(source);
}

std::uint64_t Origins::dropped() const {
  const MutexLock lock(mutex_);
  return dropped_;
}

std::vector<ForeignSource> Origins::new_sources() {
  const MutexLock lock(mutex_);
  CULPRIT_ASSERT(told_ <= sources_.size());
  const std::vector<ForeignSource> all(sources_.begin() + static_cast<std::ptrdiff_t>(told_),
                                       sources_.end());
  told_ = sources_.size();
  return all;
}

}  // namespace culprit::rtps
