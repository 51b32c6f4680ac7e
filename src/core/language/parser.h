// Source text -> syntax tree. Looks up nothing and computes nothing.
//
// Statements are lines, so parsing goes on behind every mistake: one run reports them all, and a
// broken line never makes a good one look broken. What was broken is marked in the tree, so that
// later stages do not report what follows from it.
#pragma once

#include <functional>
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

// Only some of the lines: from `begin`, where a line begins that the parser meets as it meets the
// first one of a text, or a whole RULE line, up to the first line that `is_known`. That is asked
// where a line begins that is in no TEMPLATE, and behind no part of a rule that stands before one;
// `is_in_rule`: a part of a rule would be the last one's. What the lines say is put behind what
// `file` has of those in front of them. Gives where the first line begins that is left; the size of
// the text if none is.
std::uint32_t parse_lines(const Source& source, std::uint32_t begin,
                          const std::function<bool(std::uint32_t line, bool is_in_rule)>& is_known,
                          syntax::File& file, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
