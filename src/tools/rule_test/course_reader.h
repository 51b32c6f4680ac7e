// Reads the text after the subject on a TOPIC, SIGNAL, LEVEL or PARAMETER line: its course over
// time.
#pragma once

#include <optional>

#include "language/line_reader.h"
#include "language/rule_set.h"
#include "language/scanner.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

// Bounds of what a course can make a run cost.
inline constexpr double kHighestRate = 1000;  // Hz
inline constexpr Duration kShortestPeriod = std::chrono::milliseconds(1);

// Reports and gives nothing if it cannot be understood.
std::optional<Course> read_course(Scanner& scanner, LineReader& read, const RuleSet& rules,
                                  Subject subject);

}  // namespace culprit::rule_test
