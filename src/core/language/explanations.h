// The explanation of each diagnostic: the pages of `culprit explain` and docs/diagnostics.md.
#pragma once

#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "language/live_inventory.h"
#include "language/symbols.h"

namespace culprit {

// `wrong` and `right` are whole rule files: checking `wrong` gives `code` and nothing else,
// checking `right` gives nothing.
struct Explanation {
  Code code;
  std::string title;  // one line, no full stop
  std::string why;    // a paragraph: what it means for the robot, and what to do
  std::string wrong;
  std::string right;
  Strictness strictness = Strictness::kLenient;  // of the check that finds it
  bool needs_robot = false;                      // found by checking against example_robot()
};

// A robot with one camera.
const LiveInventory& example_robot();

// One for each code, ascending.
const std::vector<Explanation>& explanations();

// The explanation of "R012", also written "r012" or "12". Null if there is no such code.
const Explanation* find_explanation(std::string_view code);

// One explanation for a terminal.
std::string page(const Explanation& explanation);

// All of them: docs/diagnostics.md.
std::string diagnostics_as_markdown();

}  // namespace culprit
