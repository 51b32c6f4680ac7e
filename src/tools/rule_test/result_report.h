// Results of tests for people and for build servers.
#pragma once

#include <string>
#include <vector>

#include "rule_test/runner.h"

namespace culprit::rule_test {

// One line if the test is ok. Otherwise also every expectation that was not met, with its place in
// the test file, and a timeline of what happened.
std::string report(const Result& result, const Source& source, const RuleSet& rules);

// The results of one test file with one rule file.
struct SuiteReport {
  std::string name;
  struct Case {
    std::string name;
    Duration length{};    // virtual
    std::string failure;  // the report of a failed test; empty: it is ok
  };
  std::vector<Case> cases;
};

// JUnit's XML, as build servers read it. Times are those of the robot's clock.
std::string junit(const std::vector<SuiteReport>& suites);

}  // namespace culprit::rule_test
