#include "language/program.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "language/checker.h"

namespace culprit {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

// The signals that each alternative of the trigger reads.
std::vector<std::vector<std::string>> alternatives_of(const std::string& trigger) {
  const auto checked =
      check(Source("a.rules", "RULE R\nPOLICIES ERROR REPORT\nTRIGGER " + trigger + "\n"));
  const RuleSet& rules = *checked.rules;
  std::vector<std::vector<std::string>> all;
  for (const Program& each : alternatives(rules[RuleId(std::size_t{0})].trigger)) {
    auto& read = all.emplace_back();
    for (const Instruction& instruction : each.code) {
      if (instruction.op == Op::kInput)
        read.push_back(rules[rules[InputId(instruction.operand)].signal].name);
    }
  }
  return all;
}

TEST(Alternatives, AreThePartsOfWhichOneIsEnough) {
  EXPECT_THAT(alternatives_of("x > 1 || y > 2 && z > 3 || !(u > 4 || v > 5)"),
              UnorderedElementsAre(ElementsAre("x"), ElementsAre("y", "z"), ElementsAre("u", "v")));
  EXPECT_THAT(alternatives_of("x > 1 || (y > 2 || z > 3)"),
              UnorderedElementsAre(ElementsAre("x"), ElementsAre("y"), ElementsAre("z")));
}

TEST(Alternatives, IsTheWholeWhereNoneIsEnough) {
  EXPECT_THAT(alternatives_of("(x > 1 || y > 2) && z > 3"),
              ElementsAre(ElementsAre("x", "y", "z")));
}

}  // namespace
}  // namespace culprit
