// The components that a person ended, and that came up no more since, as the past of a run has them (StaysDown).
#pragma once

#include <set>
#include <vector>

#include "knowledge/history.h"
#include "knowledge/known_robot.h"
#include "language/rule_set.h"

namespace culprit::live {

std::set<ComponentId> that_stay_down(const History& past);

// The rules give a component another NODE than it had when it was seen. A person ended that one, and its process was of that
// one: `past` says nothing of the component.
void forget_the_renamed(const KnownRobot& known, const RuleSet& rules, History& past);

// A person ended `launched` before, and launches them now.
void forget_that_stay_down(const std::vector<KnownRobot::Part>& launched, const RuleSet& rules,
                           History& past);

}  // namespace culprit::live
