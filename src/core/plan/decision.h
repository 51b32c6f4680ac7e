// A plan with its reasons: the decision about each failure, its expected effect, and the changes
// that would have led to another one.
#pragma once

#include <string>
#include <vector>

#include "plan/flip.h"

namespace culprit::plan {

// With very many failures, changes are looked for in so many decisions, the first ones: each takes
// some fifty plans for all failures.
inline constexpr std::size_t kMostFlipped = 20;

struct ExplainedDecision {
  Decision decision;
  std::vector<RuleId> explains;  // failures that are expected to clear with it
  std::vector<std::vector<Change>>
      flips;  // by candidate; empty: chosen, none found, or none sought
};

// The decisions of `planner` about `failures`, in the order in which it made them.
std::vector<ExplainedDecision> decide(const Planner& planner, std::vector<RuleId> failures,
                                      const Knowledge& knowledge);

// How things would be with `change`, behind "`loser` would be chosen if": "its success probability
// were at least 87.3 % (is 60 %)". `knowledge` is how they are.
std::string describe(const Change& change, StrategyId loser, const Knowledge& knowledge);

}  // namespace culprit::plan
