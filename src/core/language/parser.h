// Source text -> syntax tree. Looks up nothing and computes nothing.
//
// Statements are lines, so parsing goes on behind every mistake: one run reports them all, and a
// broken line never makes a good one look broken. The tree marks broken parts, so that later stages
// do not report errors that follow from them.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// Never fails: text that cannot be understood is reported and left out. If `lexemes` is given, the
// words of the statements are appended to it, without comments.
syntax::File parse(const Source& source, std::vector<Diagnostic>& diagnostics,
                   std::vector<Lexeme>* lexemes = nullptr);

// A text and all that the parser made of it.
struct Parsed {
  Source source;
  syntax::File file;
  std::vector<Diagnostic> said;  // by the parser
};
Parsed parse_whole(Source source);

}  // namespace culprit
