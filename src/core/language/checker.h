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
#include "language/reuse/expansion.h"
#include "language/rule_set.h"
#include "language/source.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

struct Parsed;  // language/parser.h

struct Checked {
  std::optional<RuleSet> rules;         // nothing if there is any error
  std::vector<Diagnostic> diagnostics;  // errors and warnings, in the order of the text
  syntax::File file{};                  // the tree of the rules; empty if they were parsed already
  // The typed conditions (triggers and WHENs) that the checks used; they point into the tree.
  // Destroying so many small objects takes long: a process that exits anyway need not.
  std::vector<RuleConditions> conditions{};
};

Checked check(const Source& source, Strictness strictness = Strictness::kLenient);
// Checks rules that were put together (reuse/expansion.h).
Checked check(const Expansion& rules, Strictness strictness = Strictness::kLenient);
// The same of a text that is parsed already, and has no INCLUDE, TEMPLATE or USE.
Checked check(const Parsed& whole, Strictness strictness = Strictness::kLenient);
// `whole` is of `rules.source`.
Checked check(const Expansion& rules, const Parsed& whole,
              Strictness strictness = Strictness::kLenient);

}  // namespace culprit
