// t04: a rule set that a program builds, here a rule for each wheel of a robot.
//
// Rules are text; what a program writes is checked like what a person writes, with the same
// diagnostics.
#include <cstdio>
#include <string>

#include "language/checker.h"

using namespace culprit;

namespace {

std::string rule_for(const std::string& wheel) {
  return "COMPONENT " + wheel + " NODE /base/" + wheel + "\n" + "RULE " + wheel +
         "_Stalled\n"
         "  POLICIES ERROR FOR 500ms\n"
         "  TRIGGER age(/base/" +
         wheel +
         "/joint_state) > 300ms\n"
         "    STRATEGY restart 70 10\n"
         "      ADAPTATION " +
         wheel + " restart 3\n";
}

}  // namespace

int main() {
  std::string text = "ROBOT rover\n";
  for (const char* wheel : {"front_left", "front_right", "rear_left", "rear_right"})
    text += rule_for(wheel);
  const Source source("rover.rules", text);
  const Checked checked = check(source);
  for (const Diagnostic& diagnostic : checked.diagnostics)
    std::fputs(render(diagnostic, source).c_str(), stderr);
  if (!checked.rules) return 1;
  std::printf("%zu rules for %zu components\n", checked.rules->rules.size(),
              checked.rules->components.size());
  for (const Rule& rule : checked.rules->rules)
    std::printf("%s: %zu strategies\n", rule.name.c_str(), rule.strategies.size());
  return 0;
}
