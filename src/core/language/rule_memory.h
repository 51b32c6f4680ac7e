// What a check remembers of each rule, for the next check of a text that is nearly the same.
//
// What a check makes of a rule follows from the rule's own bytes and from what its names mean: so a
// rule whose bytes are those of one before, and of whose names the same is known (Symbols::Uses),
// is not typed, compiled and reasoned about again. What is left of it is moved to where the rule
// stands now, and its ids become those of now. Names that are declared, types that are found by
// use, and what rules do to one another are looked at anew each time.
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
  // Of what it means; nothing: that was not looked at, for there was some mistake in the file.
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
  // What was made of them, with the ids of then.
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

// Nothing if its components have another order now: what is said of them goes by it.
// @pre `remembered.uses` was asked again (Symbols::ask_again), `written` has the bytes that it had
std::optional<RenewedRule> renewed(RememberedRule& remembered, const syntax::Rule& written,
                                   RuleId id, StrategyId first, RuleMemory& memory);

}  // namespace culprit
