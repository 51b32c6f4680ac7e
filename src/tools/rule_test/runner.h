// Plays a test on the real manager in virtual time, and compares what it did with what was
// expected.
//
// No clock, no thread, nothing random: the same test gives the same timeline.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plan/planner.h"
#include "rule_test/reader.h"

namespace culprit::rule_test {

struct Disappointment {
  Span expectation;     // where it stands in the test file
  std::string instead;  // what happened instead
};

struct Result {
  std::string name;
  Duration length{};
  std::vector<Event> events;  // all that the manager said
  std::vector<Disappointment> disappointments;

  bool is_ok() const { return disappointments.empty(); }
};

// `test` must be one of `suite`, which was read for `rules` without errors.
Result run_test(const RuleSet& rules, const Suite& suite, const Test& test,
                std::unique_ptr<const Planner> planner);

}  // namespace culprit::rule_test
