// Reads the text after EXPECT on a line.
#pragma once

#include <optional>

#include "language/line_reader.h"
#include "rule_test/expectation.h"
#include "rule_test/names.h"

namespace culprit::rule_test {

// Reports and gives nothing if it cannot be understood. The span is left to the caller.
std::optional<Expectation> read_expectation(Scanner& scanner, LineReader& read, Names& names);

}  // namespace culprit::rule_test
