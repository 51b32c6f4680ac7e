// Source text -> syntax tree. Looks up nothing and computes nothing.
//
// Statements are lines, so parsing goes on behind every mistake: one run reports them all, and a
// broken line never makes a good one look broken. What was broken is marked in the tree, so that
// later stages do not report what follows from it.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// Never fails: what cannot be understood is reported and left out. What the statements are written
// with is entered into `lexemes`, if wanted; comments are not.
syntax::File parse(const Source& source, std::vector<Diagnostic>& diagnostics,
                   std::vector<Lexeme>* lexemes = nullptr);

}  // namespace culprit
