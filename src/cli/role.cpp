#include "cli/role.h"

#include <random>

#include "cli/journal_file.h"
#include "cli/paths.h"
#include "manager/manager.h"

namespace culprit::cli {
namespace {

std::int64_t random_id() {
  std::random_device random;
  return std::int64_t{random()} << 31 ^ random();
}

}  // namespace

Expected<RoleOfCulprit> RoleOfCulprit::claim(const RuleSet& rules, std::uint32_t domain) {
  // The variable makes one machine look like two.
  RoleOfCulprit role(
      "culprit-manages-" + std::to_string(domain) + "-" + rules.robot + environment("CULPRIT_LOCK"),
      {rules.robot, wall_now(), random_id()});
  if (const auto taken = role.take_lock(); !taken) return Error{taken.error()};
  if (role.lock_) return role;
  role.role_ = Role::kAdvise;
  role.reason_ = "another culprit manages this robot; this one only says what it would do";
  return role;
}

Expected<void> RoleOfCulprit::take_lock() {
  if (lock_) return {};
  auto taken = ros2::NamedLock::take(lock_name_);
  if (!taken) return Error{taken.error()};
  lock_ = std::move(*taken);
  return {};
}

bool RoleOfCulprit::has_changed(const ros2::Link& link, Time now, Time joined) {
  const auto elder = link.elder();
  if (!elder && !take_lock()) return false;
  const Role before = role_;
  role_ = elder || !lock_ ? Role::kAdvise : Role::kManage;
  if (role_ == before) return false;
  if (role_ == Role::kManage) {
    if (now < later(joined, Manager::kDiscovery)) {
      role_ = before;
      return false;
    }
    reason_ = "the other culprit is gone; this one manages the robot from now on";
  } else {
    reason_ = "another culprit manages this robot, on " + *elder +
              "; this one only says what it would do";
  }
  return true;
}

}  // namespace culprit::cli
