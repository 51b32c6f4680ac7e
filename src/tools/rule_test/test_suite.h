// Tests from texts, for tests of how they are read and run.
#pragma once

#include <string>

#include "rule_test/result_report.h"

namespace culprit::rule_test {

// A camera and a fusion that needs it, each with a failure that is healed by a restart or else by a
// redeploy; and a blur that a parameter heals.
RuleSet pipeline_rules(const std::string& more = "");

// The robot of these rules when it is well, to stand before the tests.
extern const char* const kPipeline;

struct Played {
  Source source;
  RuleSet rules;
  Suite suite;
  Result result;

  // The disappointments, in one line each.
  std::vector<std::string> instead() const;
  std::string text() const { return report(result, source, rules); }
};

// Reads and runs one test, written without its TEST line. A mistake in it fails the test that asks.
// The rules are the pipeline's, with `more_rules` behind them.
Played play(const std::string& test, const std::string& more_rules = "");

}  // namespace culprit::rule_test
