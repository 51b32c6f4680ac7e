// Explanations of the findings. The source is docs/findings.md, which is compiled in: there is no second text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit::doctor {

struct Explanation {
  std::string code;
  std::string title;   // one line, no full stop
  std::string why;     // what it means for the robot
  std::string found;   // from what it is found, and when it is not reported
  std::string remedy;  // how to mend it
};

// One for each code, ascending. A code never changes its meaning, and is never used again.
const std::vector<Explanation>& explanations();

// The explanation of "D012", also written "d012". Null if there is no such code.
const Explanation* find_explanation(std::string_view code);

// One explanation for a terminal.
std::string page(const Explanation& explanation);

// All of them: docs/findings.md.
std::string_view findings_page();

}  // namespace culprit::doctor
