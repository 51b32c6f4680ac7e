// Rule file -> checked rule set: the whole front end in one call.
#pragma once

#include <optional>
#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/source.h"
#include "language/symbols.h"

namespace culprit {

struct Checked {
  std::optional<RuleSet> rules;         // nothing if there is any error
  std::vector<Diagnostic> diagnostics;  // errors and warnings, in the order of the text
};

Checked check(const Source& source, Strictness strictness = Strictness::kLenient);
// The same; `file` becomes what the source says, for those who need it too.
Checked check(const Source& source, syntax::File& file,
              Strictness strictness = Strictness::kLenient);

}  // namespace culprit
