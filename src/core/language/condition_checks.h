// Design-time checks of what triggers and WHEN conditions say: never, always, not together. All are
// warnings, given only where the values of the inputs leave no doubt (language/facts.h).
#pragma once

#include <string_view>
#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"
#include "language/typing.h"

namespace culprit {

// A rule's conditions before they are compiled.
struct RuleConditions {
  struct When {
    StrategyId strategy;
    Typed condition;
  };
  const syntax::Rule* written = nullptr;
  RuleId rule;
  Typed trigger;
  bool never_fires = false;                         // certainly
  std::vector<When> whens;                          // of the strategies that have one
  std::vector<const syntax::Strategy*> strategies;  // as written, in the order of the rule's
};

// Triggers, or parts of one, that are always or never true; WHEN conditions that are never true, or
// never together with the trigger.
void check_conditions(const RuleConditions& rule, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics);

// A condition of the whole file: an INTERLOCK or an ABORT.
struct FileCondition {
  std::string_view keyword;
  Typed condition;
};

// An INTERLOCK or an ABORT that is always or never true.
void check_file_conditions(const std::vector<FileCondition>& conditions, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics);

// An INTERLOCK that is false whenever the trigger of a rule is true: the rule's strategies never start.
void check_interlocked_rules(const std::vector<RuleConditions>& rules_of_file,
                             const std::vector<FileCondition>& conditions, const RuleSet& rules,
                             std::vector<Diagnostic>& diagnostics);

// A trigger that is true as long as everything lives.
void check_true_when_well(const RuleConditions& rule, const RuleSet& rules,
                          std::vector<Diagnostic>& diagnostics);

// Values that a trigger compares with and that were hardly meant: a rate of less than one message
// within its window, percent of a core, a ratio for a percentage, bytes for MiB, a number in quotes.
void check_compared_values(const RuleConditions& rule, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics);

// A rule that fires when something falls silent, of which no strategy helps against a hung process,
// though there is a LAUNCH command.
void check_last_resort(const RuleConditions& rule, const RuleSet& rules,
                       std::vector<Diagnostic>& diagnostics);

// A last resort that the rule's own COOLDOWN delays.
void check_cooldown(const RuleConditions& rule, const RuleSet& rules,
                    std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
