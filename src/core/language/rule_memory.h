// Remembers the results of a check for each rule, for the next check of a text that is nearly the
// same.
//
// The result for a rule depends only on the rule's own bytes and on the meaning of its names. So a
// rule is not typed, compiled and reasoned about again if its bytes are unchanged and its names
// mean the same (Symbols::Uses). Its result is moved to where the rule stands now, with the ids of
// now. Declared names, inferred types, and conflicts between rules are checked anew each time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "language/condition_checks.h"
#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

struct RememberedRule {
  // Whether a line of it is broken, or a part of a rule stood before it and outside of any.
  bool has_broken_part = false;
  std::uint32_t begin = 0;  // where it stood
  Symbols::Uses uses;
  std::vector<Diagnostic> said;  // while it was checked by itself
  // Diagnostics about its meaning; empty: not checked, because the file had a mistake.
  std::optional<std::vector<Diagnostic>> meaning;
  std::uint64_t check = 0;                // the number of the last one that met it
  std::size_t rule = 0;                   // index of RuleMemory::rules
  std::optional<std::size_t> conditions;  // index of RuleMemory::conditions
};

struct RuleMemory {
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const {
      return std::hash<std::string_view>()(text);
    }
  };
  // By their text: from the RULE line to the next one that is in no TEMPLATE.
  std::unordered_map<std::string, RememberedRule, TextHash, std::equal_to<>> known;
  // The results for them, with the ids of that check.
  std::vector<Rule> rules;
  std::vector<Strategy> strategies;
  std::vector<RuleConditions> conditions;
  Duration cycle{};
  std::uint64_t check = 0;  // the number of the last one

  // Takes from the rule set that the check gave what the next one may need of it.
  void take(RuleSet& checked);
};

// A rule of the last check, with the places and ids of this one; its inputs are left out.
struct RenewedRule {
  Rule rule;
  std::vector<Strategy> strategies;
  std::optional<RuleConditions> conditions;
};

// Empty if its components have another order now: the diagnostics depend on it.
// @pre `remembered.uses` was asked again (Symbols::ask_again), `written` has the bytes that it had
std::optional<RenewedRule> renewed(RememberedRule& remembered, const syntax::Rule& written,
                                   RuleId id, StrategyId first, RuleMemory& memory);

}  // namespace culprit
