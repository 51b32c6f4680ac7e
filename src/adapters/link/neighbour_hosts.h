// Which other computers take part in the domain, and of which of them nothing is heard any more.
//
// A computer is called silent when nothing came from any of its participants for kPatience, and it had
// two or more: what is silent with only one may as well be that one process. What it ran last counts,
// also after the leases of its participants ran out; who said good-bye does not. While we ourselves may
// not have heard (listens_from), nobody is silent.
//
// Computers are told apart by the names that participants say. Two of one name, or a stranger who says
// that name from another computer, are taken for one: it is heard as long as either is, and then a
// silent node counts as it would on any computer. What runs on this computer is no witness of another.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "base/mutex.h"
#include "base/time.h"
#include "ros2/participant.h"
#include "rtps/guid.h"

namespace culprit::ros2 {

// All that it says of its addresses must be ours: addresses of bridges are the same on many machines.
bool is_on_this_machine(const ParticipantInfo& info);

// All members may be called from any thread.
class NeighbourHosts {
 public:
  // Participants announce themselves every 3 s, and culprit asks nodes every 400 ms.
  static constexpr Duration kPatience = std::chrono::seconds(4);
  static constexpr std::size_t kMostHosts = 100;
  static constexpr std::size_t kMostParticipants = 1000;

  // When the last datagram of a participant came (Participant::heard_last).
  using HeardLast = std::function<Time(const GuidPrefix&)>;
  explicit NeighbourHosts(HeardLast heard_last) : heard_last_(std::move(heard_last)) {}

  void joined(const GuidPrefix& participant, const std::string& host, bool is_here);
  void left(const GuidPrefix& participant, bool was_lost, Time now);

  // Nobody listened before: what did not come until `now` may have been said.
  void listens_from(Time now);

  bool is_silent(const std::string& host, Time now) const;
  // When something of it came last. kNever where that says nothing of a node there: the computer is not
  // known, or has no second participant.
  Time heard(const std::string& host) const;

 private:
  struct Host {
    std::set<GuidPrefix> there;
    std::size_t lost = 0;  // whose leases ran out since it was heard last
  };
  Time heard(const Host& host) const CULPRIT_REQUIRES(mutex_);

  const HeardLast heard_last_;
  mutable Mutex mutex_;
  std::map<std::string, Host> hosts_ CULPRIT_GUARDED_BY(mutex_);  // by name
  std::map<GuidPrefix, std::string> host_of_ CULPRIT_GUARDED_BY(mutex_);
  Time listens_from_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
};

}  // namespace culprit::ros2
