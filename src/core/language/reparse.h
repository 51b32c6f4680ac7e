// A text that changes a little at a time -> its syntax tree, as somebody types.
//
//     Parsed parsed = parse_whole(Source(name, text));
//     parsed = reparse(std::move(parsed), Source(name, text_after_a_keystroke));
//
// A RULE line begins anew whatever the lines before it contain, and so does each line in front of
// the first one, so the tree can be cut there. Parts in front of the change stay as they are; parts
// behind it are moved to where they stand now; only the lines between are parsed. The result is the
// same in every part as a parse of the whole text. The meaning of names is not checked here.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

struct Parsed {
  Source source;
  syntax::File file;
  std::vector<Diagnostic> said;  // by the parser
};

Parsed parse_whole(Source source);

// The same as parse_whole(source), whatever `before` is of.
Parsed reparse(Parsed before, Source source);

}  // namespace culprit
