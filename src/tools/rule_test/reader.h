// The text of a test file -> its tests, every name looked up in the rules that they test.
//
// Statements are lines, as in rule files, and reading goes on after every mistake. Statements
// before the first TEST hold for every test of the file.
#pragma once

#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"
#include "rule_test/expectation.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

// A bound of what a file can make a run cost.
inline constexpr Duration kLongestRun = std::chrono::hours(1);

struct Test {
  std::string name;
  Span span;
  Scenario scenario;  // beyond what all tests of the file share
  std::vector<Expectation> expectations;
  Duration length{};  // zero: to the end of the bag
  std::string bag{};  // that is played instead of a scenario, as written; empty: none
};

struct Suite {
  Scenario shared;
  std::vector<Test> tests;
};

// The files that the RULES lines name, as written. Reports if there is none.
std::vector<syntax::Name> rule_files(const Source& source, std::vector<Diagnostic>& diagnostics);

// Reads everything but the RULES lines. Invalid statements are reported and left out: a suite may
// be run only if no diagnostic is an error.
Suite read_suite(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit::rule_test
