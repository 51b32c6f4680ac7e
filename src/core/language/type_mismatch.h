// Messages about operands whose types do not fit together.
#pragma once

#include <string>

#include "language/diagnostic.h"
#include "language/symbols.h"
#include "language/syntax.h"
#include "language/typing.h"

namespace culprit {

bool is_comparison(const syntax::Expression& e);  // as in a < b

// `e` has values of `left` and of `right` as its operands, as written; `verb`: what it does with
// them ("compare").
Diagnostic type_mismatch(const syntax::Expression& e, Type left, Type right,
                         const std::string& verb, const Symbols& symbols);

}  // namespace culprit
