// An expression that has to be true or false: a trigger, a WHEN, an INTERLOCK, an ABORT.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "language/symbols.h"
#include "language/syntax.h"
#include "language/typing.h"

namespace culprit {

// `what` names it for people: "a trigger". Nothing: it has another type, or none, and that was
// reported.
std::optional<Typed> typed_condition(const syntax::Expression& expression, const std::string& what,
                                     Symbols& symbols, std::vector<Diagnostic>& diagnostics);

// Whether the evaluator has room for it; reported if not.
bool fits_stack(const Typed& typed, const syntax::Expression& expression,
                std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
