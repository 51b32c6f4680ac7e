// Which culprit manages a robot, of those on different machines in its DDS domain. (On one machine
// a lock decides, cli/host_claim.h.)
//
// Each announces that it would, by writers on the hidden topic /_culprit_lease that say in their
// user data which robot, which nodes, and since when. Nothing is ever written: discovery alone
// tells everybody of everybody, and that one is gone, at once if it ended in order, else when its
// lease of 20 s is over. The one that began first, by its own clock, manages; of two that began at
// once, the one with the lower id. All come to the same answer, so a robot has one manager also
// after a network that was in two parts has come together. Two that name different robots and the
// same node are told apart likewise, for that node.
//
// Anybody in the domain could announce so. A claim counts if it carries a proof that its
// participant knows the key that both were given (HMAC-SHA-256 over the claim and the participant's
// GUID prefix). What has none is a stranger's: told of, and not given way to.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros2/participant.h"

namespace culprit::ros2 {

struct LeaseClaim {
  std::string robot;
  std::int64_t since = 0;  // nanoseconds since 1970
  std::int64_t id = 0;     // of the process: random
  // That it adapts, by full name; "*/camera" for a node of that own name in any namespace.
  std::vector<std::string> nodes{};
  std::string key{};  // shared by those who believe each other; empty: no claim but our own counts
};

class ManagerLease {
 public:
  static constexpr const char* kTopic = "rt/_culprit_lease";
  static constexpr const char* kType = "culprit::msg::dds_::Lease_";

  // `self` is the participant that announces it.
  ManagerLease(LeaseClaim own, GuidPrefix self) : own_(std::move(own)), self_(self) {}

  // What the own writers say in their user data: one for each, for not all nodes may fit into one.
  std::vector<std::string> announcements() const;
  void apply(const DiscoveryEvent& event);

  // Participants that are left out: those of this machine.
  using IsLeftOut = std::function<bool(const GuidPrefix&)>;

  // The participant of the culprit that goes before this one; nothing if this one manages.
  std::optional<GuidPrefix> elder(const IsLeftOut& is_left_out = {}) const;
  // The participant of a culprit of another robot that goes before this one at the node of this
  // full name.
  std::optional<GuidPrefix> elder_at(const std::string& node,
                                     const IsLeftOut& is_left_out = {}) const;
  // Who claims this robot, or a node of it, and does not prove it.
  std::vector<GuidPrefix> strangers(const IsLeftOut& is_left_out = {}) const;

 private:
  static constexpr std::size_t kMostStrangers = 100;  // that are kept track of

  using Rank = std::pair<std::int64_t, std::int64_t>;  // since when, id
  struct Other {
    std::string robot;
    Rank rank;
    std::vector<std::string> nodes;
    bool is_proven = false;
  };

  bool concerns_us(const Other& other) const;
  template <class Predicate>
  std::optional<GuidPrefix> first(const IsLeftOut& is_left_out, Predicate is_rival) const;

  LeaseClaim own_;
  GuidPrefix self_;
  std::map<Guid, Other> others_;  // that concern us
};

}  // namespace culprit::ros2
