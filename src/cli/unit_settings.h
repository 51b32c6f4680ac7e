// The minimal permissions that a rule file needs from systemd: a drop-in for
// packaging/culprit.service, which forbids what no rule file needs.
//
// It depends on three things: whether the rules start programs (which then live in culprit's
// sandbox), whether they end processes, and whether those are another user's.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "language/rule_set.h"

namespace culprit::cli {

enum class NodeOwner : std::uint8_t {
  kSameUser,   // the robot's nodes run as the unit's User=
  kOtherUsers  // or as somebody else
};

struct UnitOptions {
  std::string rules;  // the absolute path of the rule file
  NodeOwner nodes = NodeOwner::kSameUser;
  // The service's variables for the domain: ROS_DOMAIN_ID, ROS_SECURITY_ENABLE ...
  std::vector<std::pair<std::string, std::string>> environment{};
};

std::string unit_settings(const RuleSet& rules, const UnitOptions& options);

}  // namespace culprit::cli
