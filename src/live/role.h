// Whether this culprit manages the robot, or only advises because another one manages it; and which
// components belong to another culprit, one that calls the robot by another name.
//
// Two managers would undo each other's work. On one machine a claim that the kernel keeps decides
// (host_claim.h), among machines the lease (ros2/manager_lease.h). Both are checked again while
// culprit runs. The name of its node decides which culprit manages a component.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/time.h"
#include "journal/inheritance.h"
#include "journal/standing_orders.h"
#include "language/rule_set.h"
#include "link/lease_link.h"
#include "live/host_claim.h"

namespace culprit::live {

enum class Role : std::uint8_t { kManage, kAdvise };

// The components that strategies adapt.
std::set<ComponentId> adapted_components(const RuleSet& rules);

class RoleOfCulprit {
 public:
  // `key` is what culprits on other machines prove themselves by; empty: they cannot.
  RoleOfCulprit(const RuleSet& rules, std::uint32_t domain, std::string key);

  Role role() const { return role_; }
  // To be announced over DDS: the same until the role is another one.
  const link::LeaseClaim& lease() const { return lease_; }

  // Looks anew. Gives whether the role is another one now, which takes a new beginning. `joined`:
  // when it joined the domain; an elder manager may take a while to be discovered.
  bool has_changed(const link::LeaseLink* lease, Time now, Time joined);
  // For the user: why it has this role. Empty: it manages from the start.
  const std::string& reason() const { return reason_; }

  // The process of the other culprit that was last seen to manage the robot, 0 for one on another
  // machine; nothing: none was.
  std::optional<int> manager_before() const { return manager_before_; }

  // Orders as reported by the latest other culprit that managed the robot; empty: there was none.
  // Error: there was one, and its orders are unknown.
  Expected<std::optional<journal::StandingOrders>> told_orders(const link::LeaseLink* lease) const;

  // Learned and tried by that culprit, as of `now`; empty: there was none. Error: the reason
  // why it is unknown.
  std::optional<Expected<journal::Inheritance>> told_inheritance(const link::LeaseLink* lease,
                                                                 const RuleSet& rules,
                                                                 Time now) const;

  // Which of these nodes another culprit manages, and who that is. Looks anew; nodes that are no
  // longer among them are given up.
  std::map<std::string, std::string> managed_elsewhere(const std::set<std::string>& nodes,
                                                       const link::LeaseLink* lease);

  // Warnings about foreign claims, each once.
  std::vector<std::string> warnings(const link::LeaseLink* lease);

 private:
  std::string name_of_claim(const std::string& what) const;

  std::uint32_t domain_;
  link::LeaseClaim lease_;
  HostClaim claim_;
  std::map<std::string, HostClaim> node_claims_;
  Role role_ = Role::kManage;
  bool had_elder_ = false;  // this role is, or the last one was, because of one on another machine
  std::optional<int> manager_before_;
  std::string reason_;
  std::set<std::string> warned_;
};

}  // namespace culprit::live
