// Rules x robot -> the parts of the rules that this robot has, for people. live_checks.h reports
// the missing ones.
#pragma once

#include <string>
#include <vector>

#include "language/live_inventory.h"
#include "language/rule_set.h"

namespace culprit::live_checks {

// One line for each component, topic and signal that is there, in the order of the rules: "camera
// is /robot/camera, active ✓", "/scan 10 Hz from /lidar ✓", "entropy = 0.03 ✓". A topic that is
// there without a message yet has no tick: "/scan from /lidar, silent".
std::vector<std::string> findings(const RuleSet& rules, const LiveInventory& robot);

// Whether the wait is over: each of them is there, with its rate or value.
bool is_all_found(const RuleSet& rules, const LiveInventory& robot);

}  // namespace culprit::live_checks
