// Which culprit manages a robot, of all that are in its DDS domain, on whichever machine.
//
// Each announces that it would, by a writer on the hidden topic /_culprit_lease that says in its
// user data which robot and since when. Nothing is ever written: discovery alone tells everybody of
// everybody, and that one is gone, at once if it ended in order, else when its lease of 20 s is
// over. The one that began first, by its own clock, manages; of two that began at once, the one
// with the lower GUID. All come to the same answer, so a robot has one manager also after a network
// that was in two parts has come together.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "ros2/participant.h"

namespace culprit::ros2 {

struct LeaseClaim {
  std::string robot;
  std::int64_t since = 0;  // nanoseconds since 1970
  std::int64_t id = 0;     // of the process: random
};

class ManagerLease {
 public:
  static constexpr const char* kTopic = "rt/_culprit_lease";
  static constexpr const char* kType = "culprit::msg::dds_::Lease_";

  explicit ManagerLease(LeaseClaim own) : own_(std::move(own)) {}

  // What the own writer says in its user data.
  std::string user_data() const;
  void apply(const DiscoveryEvent& event);

  // The participant of the culprit that goes before this one; nothing if this one manages.
  std::optional<GuidPrefix> elder() const;

 private:
  static constexpr std::size_t kMost = 1000;  // that are kept track of

  using Rank = std::pair<std::int64_t, std::int64_t>;  // since when, id

  LeaseClaim own_;
  std::map<Guid, Rank> others_;  // of this robot
};

}  // namespace culprit::ros2
