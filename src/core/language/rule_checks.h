// Design-time checks of rules that parse and type: what cannot work, or cannot be meant.
#pragma once

#include <vector>

#include "language/condition_checks.h"
#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"

namespace culprit {

class Symbols;

// For each adaptation whether it begins a step: THEN. Without any THEN, one that brings up again what
// an earlier one took down for an adaptation between the two.
std::vector<bool> steps_of(const syntax::Strategy& strategy);

// A strategy that contradicts itself: in one step, it adds a node twice, activates and deactivates it,
// redeploys and reconfigures it, sets one parameter twice. A step may take back what an earlier one
// did, but cannot follow where a component was stopped.
void check_contradictions(const syntax::Strategy& strategy, std::vector<Diagnostic>& diagnostics);

// Strategies that need a LAUNCH command that is not there, and rules for which no strategy is left
// then. `said`: the number of diagnostics before those of this rule.
void check_launches(const syntax::Rule& rule, const Symbols& symbols, const RuleSet& rules,
                    RuleId id, std::size_t said, std::vector<Diagnostic>& diagnostics);

// Strategies that stop a REQUIRED component, and leave it stopped. A last resort may.
void check_required(const syntax::Rule& rule, const RuleSet& rules, RuleId id,
                    std::vector<Diagnostic>& diagnostics);

// Strategies that only restart or redeploy what depends on the component that the trigger is about, by
// declared dependencies. A last resort may.
void check_effects(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics);

// A trigger that reads nothing is always or never true.
void check_constant_trigger(const syntax::Rule& rule, const Program& trigger,
                            std::vector<Diagnostic>& diagnostics);

// Declared dependencies that form a loop.
void check_circles(const syntax::File& file, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
