// Rule file -> checked rule set: the whole front end in one call.
//
//     const Checked checked = check(Source("robot.rules", text));
//     for (const Diagnostic& diagnostic : checked.diagnostics) show(diagnostic);
//     if (!checked.rules) return 1;
//     Manager manager(*checked.rules, std::make_unique<BayesPlanner>(), {});
#pragma once

#include <optional>
#include <vector>

#include "language/condition_checks.h"
#include "language/diagnostic.h"
#include "language/reparse.h"
#include "language/reuse/expansion.h"
#include "language/rule_memory.h"
#include "language/rule_set.h"
#include "language/source.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

struct Checked {
  std::optional<RuleSet> rules;         // nothing if there is any error
  std::vector<Diagnostic> diagnostics;  // errors and warnings, in the order of the text
  syntax::File file{};                  // the tree of the rules; empty if they were parsed already
  // What triggers and WHENs were reasoned about with; they point into the tree. Destroying so many
  // small things takes long: who ends anyway need not.
  std::vector<RuleConditions> conditions{};
};

Checked check(const Source& source, Strictness strictness = Strictness::kLenient);
// Of rules that were put together (reuse/expansion.h).
Checked check(const Expansion& rules, Strictness strictness = Strictness::kLenient);
// The same of a text that is parsed already, and has no INCLUDE, TEMPLATE or USE.
Checked check(const Parsed& whole, Strictness strictness = Strictness::kLenient);

// The same as a lenient check of `whole`, which takes from `memory` what an earlier one has left
// there, whatever that was of, and leaves there what the next one may take. The rule set that the
// earlier one gave has to be given back with RuleMemory::take(), if it gave one.
Checked check_again(const Parsed& whole, RuleMemory& memory);
// `whole` is of `rules.source`.
Checked check_again(const Expansion& rules, const Parsed& whole, RuleMemory& memory);

}  // namespace culprit
