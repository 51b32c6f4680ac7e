// The lines INCLUDE, TEMPLATE and USE, read off as the parser reads all others.
//
//     INCLUDE "packs/nav2.rules"
//     TEMPLATE driver(name, topic, hz = 10)
//     USE driver(lidar, /scan, 15) IN /robot1
#pragma once

#include <optional>
#include <span>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/syntax.h"

namespace culprit {

// Each stands behind its keyword. Empty: the line is not understood, and was reported.
std::optional<syntax::Include> read_include(LineReader& read, Scanner& s, Span line);
// Without its body.
std::optional<syntax::Template> read_template(LineReader& read, Scanner& s);
std::optional<syntax::Use> read_use(LineReader& read, Scanner& s, Span line);

// Reports a "{parameter}" of a line that `pattern` does not have. In a quoted text braces may have
// another meaning: there only a name near that of a parameter is a mistake. False if there is one.
bool check_holes(LineReader& read, std::string_view text, std::span<const Lexeme> line,
                 const syntax::Template& pattern);

}  // namespace culprit
