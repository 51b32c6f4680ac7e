// Source text -> syntax tree. Looks up nothing and computes nothing.
//
// Statements are lines, so parsing goes on behind every mistake: one run reports them all, and a
// broken line never makes a good one look broken. The tree marks broken parts, so that later stages
// do not report errors that follow from them.
#pragma once

#include <functional>
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

// Parses only some of the lines, and appends them to `file`, which has the lines before them.
// Begins at `begin`: a line that the parser meets in the same state as the first line of a text, or
// a whole RULE line. Stops at the first line that `is_known`. Asks that only at the begin of a line
// outside of every TEMPLATE, and not after a part of a rule that stands before any rule.
// `is_in_rule`: a part of a rule would belong to the last one. Gives where the first line begins
// that is left; the size of the text if none is.
std::uint32_t parse_lines(const Source& source, std::uint32_t begin,
                          const std::function<bool(std::uint32_t line, bool is_in_rule)>& is_known,
                          syntax::File& file, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
