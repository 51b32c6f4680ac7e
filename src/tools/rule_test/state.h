// How a robot is at one moment, written in the statements of rule tests, and what a manager knows
// that has watched it so far and done nothing.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "knowledge/knowledge.h"
#include "language/diagnostic.h"
#include "language/source.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

struct State {
  Scenario scenario;
  // When the moment is; nothing: once all that the rules wait for (FOR, HOLD, windows) has passed.
  std::optional<Duration> moment;
  std::vector<StrategyId> tried;  // without success since their failure was detected
  struct Experience {
    StrategyId strategy;
    int helped = 0;
    int did_not_help = 0;
  };
  std::vector<Experience> experiences;
};

// Invalid statements are reported and left out: a state may be used only if there are no
// diagnostics.
State read_state(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics);

// When the state's moment is, from the start of watching. At most kLongestRun.
Duration moment_of(const State& state, const RuleSet& rules);

struct Watched {
  std::unique_ptr<Knowledge> knowledge;  // of the rules that were given
  std::vector<RuleId> failures;          // that wait for a decision, ascending
  std::optional<std::string> held_back;  // why nothing would be begun now, whatever is planned
  Time now;
};

// Watches a robot in this state, in virtual time. `rules` must outlive the result.
// @pre `state` was read for `rules` without diagnostics
Watched watch(const State& state, const RuleSet& rules);

}  // namespace culprit::rule_test
