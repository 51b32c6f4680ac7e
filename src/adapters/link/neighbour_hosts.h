// The other computers in the domain, and which of them are unreachable.
//
// A computer counts as unreachable if nothing came from any of its participants for kPatience, and
// it had two or more: a single silent participant may as well be one exited process. Its last
// participants count, also after their leases ran out; a participant that left in order does not.
// While we ourselves may have missed messages (listens_from), no computer counts as unreachable.
//
// Computers are distinguished by the names that participants announce. Two of one name, or a
// stranger that announces that name from another computer, count as one: it is reachable as long as
// either is, and then a silent node counts as it would on any computer. A participant on this
// computer proves nothing about another one.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "base/mutex.h"
#include "base/time.h"
#include "ros2/participant.h"
#include "rtps/guid.h"

namespace culprit::link {

// All addresses that it announces must be ours: addresses of bridges are the same on many machines.
bool is_on_this_machine(const ros2::ParticipantInfo& info);

// All members may be called from any thread.
class NeighbourHosts {
 public:
  // Participants announce themselves every 3 s, and culprit asks nodes every 400 ms.
  static constexpr Duration kPatience = std::chrono::seconds(4);
  static constexpr std::size_t kMostHosts = 100;
  static constexpr std::size_t kMostParticipants = 1000;

  // When the last datagram of a participant came (Participant::heard_last).
  using HeardLast = std::function<Time(const rtps::GuidPrefix&)>;
  explicit NeighbourHosts(HeardLast heard_last) : heard_last_(std::move(heard_last)) {}

  void joined(const rtps::GuidPrefix& participant, const std::string& host, bool is_here);
  void left(const rtps::GuidPrefix& participant, bool was_lost, Time now);

  // Nobody listened before: messages up to `now` may have been missed.
  void listens_from(Time now);

  bool is_silent(const std::string& host, Time now) const;
  // When something of it came last. kNever where that proves nothing about a node there: the
  // computer is not known, or has no second participant.
  Time heard(const std::string& host) const;

 private:
  struct Host {
    std::set<rtps::GuidPrefix> there;
    std::size_t lost = 0;  // whose leases ran out since the last datagram
  };
  Time heard(const Host& host) const CULPRIT_REQUIRES(mutex_);

  const HeardLast heard_last_;
  mutable Mutex mutex_;
  std::map<std::string, Host> hosts_ CULPRIT_GUARDED_BY(mutex_);  // by name
  std::map<rtps::GuidPrefix, std::string> host_of_ CULPRIT_GUARDED_BY(mutex_);
  Time listens_from_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
};

}  // namespace culprit::link
