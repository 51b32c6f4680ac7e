// CONST lines -> values.
#pragma once

#include <optional>
#include <vector>

#include "language/diagnostic.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

// Defines what the file declares, in its order: a constant may use those before it.
void define_constants(const syntax::File& file, Symbols& symbols,
                      std::vector<Diagnostic>& diagnostics);

// Nothing: it has no value, or changes at run time, and that was reported.
std::optional<syntax::Literal> constant_value(const syntax::Constant& constant, Symbols& symbols,
                                              std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
