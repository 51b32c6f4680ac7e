// Expressions of the reference, with the meaning that the reference gives them.
//
//   precedence, from the tightest: ! unary+ unary- ^ | * / | + - | == != < <= > >= | && ||
//   all operators group to the left; a number before "(" multiplies
//
// So `a || b && c` is `(a || b) && c`, and the tree says that. Text that the reference's own
// tokeniser drops or cannot read (`1. && b`, `(-1)`, `!!a`, `1e-7`) is read as it is written, and
// noted.
#pragma once

#include "import/file_reader.h"
#include "language/scanner.h"

namespace culprit::foreign {

// Reads as much of `scanner` as belongs to the expression. Complains to `reader` and gives nothing
// if there is none.
std::optional<Expression> read_expression(Scanner& scanner, FileReader& reader,
                                          std::vector<std::string>& notes);

Expression binary(syntax::Operator op, Expression left, Expression right);

}  // namespace culprit::foreign
