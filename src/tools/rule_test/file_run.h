// A test file on disk, run from end to end: with each rule file that it names.
#pragma once

#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "plan/planner.h"
#include "rule_test/result_report.h"

namespace culprit::rule_test {

struct FileRun {
  bool is_usable = false;           // false: nothing was run; `complaints` says why
  std::string complaints;           // about the file and its rules, rendered; also warnings
  std::string output;               // the reports of all tests that were run
  std::vector<SuiteReport> suites;  // one for each rule file
};

// Runs the tests whose name contains `filter`, each with a planner of its own.
FileRun run_file(const std::string& path, const std::string& filter, const PlannerFactory& planner,
                 Colour colour);

}  // namespace culprit::rule_test
