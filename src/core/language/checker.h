// Rule file -> checked rule set: the whole front end in one call.
//
//     const Checked checked = check(Source("robot.rules", text));
//     for (const Diagnostic& diagnostic : checked.diagnostics) show(diagnostic);
//     if (!checked.rules) return 1;
//     Manager manager(*checked.rules, std::make_unique<BayesPlanner>(), {});
#pragma once

#include <optional>
#include <vector>

#include "language/diagnostic.h"
#include "language/reuse/expansion.h"
#include "language/rule_set.h"
#include "language/source.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

struct Checked {
  std::optional<RuleSet> rules;         // nothing if there is any error
  std::vector<Diagnostic> diagnostics;  // errors and warnings, in the order of the text
};

Checked check(const Source& source, Strictness strictness = Strictness::kLenient);
// Of rules that were put together (reuse/expansion.h).
Checked check(const Expansion& rules, Strictness strictness = Strictness::kLenient);
// The same of a file that is parsed already; `said` are the parser's complaints.
Checked check(const syntax::File& file, std::vector<Diagnostic> said,
              Strictness strictness = Strictness::kLenient);

}  // namespace culprit
