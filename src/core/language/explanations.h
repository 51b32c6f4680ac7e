// The explanation of each diagnostic. The source is docs/diagnostics.md, which is compiled in: there is no second text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "language/diagnostic.h"

namespace culprit {

// `wrong` and `right` are whole rule files: checking `wrong` gives `code` and nothing else,
// checking `right` gives nothing; with --strict where the title says so, against a robot where
// `why` describes one.
struct Explanation {
  Code code;
  std::string title;  // one line, no full stop
  std::string why;    // a paragraph: what it means for the robot, and what to do
  std::string wrong;
  std::string right;
};

// One for each code, ascending.
const std::vector<Explanation>& explanations();

// The explanation of "R012", also written "r012" or "12". Null if there is no such code.
const Explanation* find_explanation(std::string_view code);

// One explanation for a terminal.
std::string page(const Explanation& explanation);

// All of them: docs/diagnostics.md.
std::string_view diagnostics_page();

}  // namespace culprit
