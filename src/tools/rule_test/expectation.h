// A test's expectation about the manager, and whether it is met.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "knowledge/event.h"
#include "language/rule_set.h"

namespace culprit::rule_test {

struct Expectation {
  enum class Kind : std::uint8_t {
    kDetected,   // rule
    kResolved,   // rule; strategy: by this one
    kExhausted,  // rule
    kLost,       // rule
    kBlind,      // rule
    kChosen,     // strategy
    kExecuted,   // strategy: all of its adaptations took effect
    kFailed,     // strategy: it did not help, or could not be carried out
    kBlamed,     // component is held responsible; rule: for this failure
    kAnyChosen,  // any strategy; component: that adapts it; rule: of this rule
    kExcluded,   // strategy; condition: by this one; component: which is about this one
    kRanked      // strategy is the `rank`-th by cost when its failure is planned first
  };
  Kind kind = Kind::kDetected;
  bool wanted = true;  // false: it must not happen
  std::optional<RuleId> rule;
  std::optional<StrategyId> strategy;
  std::optional<ComponentId> component;
  std::optional<Condition> condition;
  std::size_t rank = 0;
  Duration after{};            // not earlier
  std::optional<Duration> by;  // not later; nothing: until the end
  Span span;                   // where it stands in the test file
};

// Empty if `events` meet the expectation; otherwise the deviation, in one line. `events` are those
// of a whole test, which started at the clock's zero.
std::optional<std::string> disappointment(const Expectation& expectation,
                                          std::span<const Event> events, const RuleSet& rules);

}  // namespace culprit::rule_test
