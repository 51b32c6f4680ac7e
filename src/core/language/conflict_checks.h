// Design-time checks of rules against each other. All are warnings.
#pragma once

#include <vector>

#include "language/condition_checks.h"
#include "language/diagnostic.h"
#include "language/rule_set.h"

namespace culprit {

// A rule that another one always covers: same components, and whenever it fails, the other one has
// failed, is at least as critical, and is no slower. Found for triggers that compare one and the
// same input with a constant.
void check_covered_rules(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                         std::vector<Diagnostic>& diagnostics);

// Strategies of two rules that undo one another, where the rules take turns: their triggers can
// hold together, or one of them holds at any time. Two that leave a band between them, as a
// thermostat does, are as they should be, unless the value that each of them sets makes the other's
// trigger true. Within one rule such strategies are alternatives.
void check_oscillation(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                       std::vector<Diagnostic>& diagnostics);

// A last resort that changes what an INTERLOCK reads: the interlock would then open, or close, because
// of culprit, and not because of the robot.
void check_interlocks(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
