// One expression of a line -> syntax tree, by precedence climbing.
//
//   loosest   ?:   ||   &&   == !=   < <= > >=   + -   * / %   ! - (unary)   tightest
//
// All binary operators group to the left, ?: to the right, as in C++.
#pragma once

#include <optional>
#include <vector>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/syntax.h"

namespace culprit {

// How deep the tree of one expression may be, chains of operators included. Bounds the stack that a
// hostile file can use.
inline constexpr int kMaxNesting = 256;

// Takes the longest expression that begins at the scanner's place. Reports and returns nothing if
// there is none.
std::optional<syntax::Expression> parse_expression(Scanner& scanner,
                                                   std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
