// Reads the text after ADAPTATION or STRATEGY on a line: the robot's answer, and the failure that
// it heals.
#pragma once

#include "language/line_reader.h"
#include "language/rule_set.h"
#include "language/scanner.h"
#include "rule_test/names.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

// They add to `scenario`, or report and give false if the line cannot be understood.
bool read_answers_of_adaptation(Scanner& scanner, LineReader& read, Names& names,
                                const RuleSet& rules, Scenario& scenario);
bool read_answers_of_strategy(Scanner& scanner, LineReader& read, Names& names,
                              const RuleSet& rules, Scenario& scenario);

}  // namespace culprit::rule_test
