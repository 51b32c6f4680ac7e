// Whether this culprit manages the robot, or only says what it would do because another one does.
//
// Two managers would undo each other's work. On one machine a lock that the kernel keeps decides,
// among machines the lease (ros2/manager_lease.h); both are looked at again while culprit runs.
#pragma once

#include <optional>
#include <string>

#include "language/rule_set.h"
#include "robot/time.h"
#include "ros2/link.h"
#include "ros2/named_lock.h"

namespace culprit::cli {

enum class Role : std::uint8_t { kManage, kAdvise };

class RoleOfCulprit {
 public:
  // Errors: no lock can be had.
  static Expected<RoleOfCulprit> claim(const RuleSet& rules, std::uint32_t domain);

  Role role() const { return role_; }
  // To be announced over DDS: the same for as long as this process lives.
  const ros2::LeaseClaim& lease() const { return lease_; }

  // Looks anew. Gives whether the role is another one now, which takes a new beginning. `joined`:
  // when `link` joined the domain; an elder manager may take a while to be discovered.
  bool has_changed(const ros2::Link& link, Time now, Time joined);
  // For the user: why it has this role. Empty: it manages from the start.
  const std::string& reason() const { return reason_; }

 private:
  RoleOfCulprit(std::string name, ros2::LeaseClaim lease)
      : lock_name_(std::move(name)), lease_(std::move(lease)) {}
  Expected<void> take_lock();

  std::string lock_name_;
  ros2::LeaseClaim lease_;
  std::optional<ros2::NamedLock> lock_;
  Role role_ = Role::kManage;
  std::string reason_;
};

}  // namespace culprit::cli
