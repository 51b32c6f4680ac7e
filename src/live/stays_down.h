// The components that a person ended, and that came up no more since, as the past of a run has them (StaysDown).
#pragma once

#include <set>
#include <vector>

#include "knowledge/history.h"
#include "knowledge/known_robot.h"
#include "language/rule_set.h"

namespace culprit::live {

std::set<ComponentId> that_stay_down(const History& past);

// A person ended `launched` before, and launches them now.
void forget_that_stay_down(const std::vector<KnownRobot::Part>& launched, const RuleSet& rules,
                           History& past);

}  // namespace culprit::live
