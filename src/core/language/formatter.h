// Rule text -> the same rules in the one canonical layout, for people to read.
//
// Only the white space between the tokens changes. Numbers, durations, names, texts, comments,
// parentheses and the order of everything stay as they are written. Included and used files stay,
// too.
//   - Indentation: RULE and declarations 0, POLICIES and TRIGGER 2, STRATEGY 4, ADAPTATION 6; between
//     TEMPLATE and END 2 more.
//   - One space around binary operators, none inside parentheses.
//   - COMPONENT, SIGNAL and CONST lines that follow each other stand in columns.
//   - Comments behind statements that follow each other stand in one column; a comment on a line of
//     its own is indented as the statement below it, else as the one above it.
//   - Runs of blank lines become one; none begins or ends the text. Lines end in LF.
#pragma once

#include <string>

#include "base/expected.h"
#include "language/diagnostic.h"
#include "language/source.h"

namespace culprit {

// Errors: the text does not parse; the message is what a check says about it, rendered in `colour`.
Expected<std::string> format(const Source& source, Colour colour = Colour::kOff);

}  // namespace culprit
