#include "diagnose/unclear.h"

#include <algorithm>

#include "diagnose/timing.h"
#include "diagnose/touched.h"

namespace culprit::diagnose {
namespace {

// When the last process of a component that the rule touches began, its node was there, and it became active, if that runs.
Time begun_last(RuleId rule, const Knowledge& knowledge) {
  Time last = kLongAgo;
  for (const ComponentId c : touched_by(rule, knowledge)) {
    const ComponentState& state = knowledge.components[c];
    if (state.process != ProcessState::kRunning) continue;
    last = std::max({last, state.process_since, state.node_seen});
    if (state.lifecycle == Lifecycle::kActive) last = std::max(last, state.lifecycle_since);
  }
  return last;
}

}  // namespace

Time shows_by(RuleId failure, Time since, const Knowledge& knowledge) {
  const Duration passing = duration_of(kPassing, knowledge.rules);
  return later(since, passing + std::min(clears_within(failure, knowledge), kLongestEvidence));
}

Time unclear_until(RuleId failure, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[failure];
  const Time last =
      std::max({begun_last(failure, knowledge), state.masked_until, state.unhelped_at});
  return last == kLongAgo ? last : shows_by(failure, last, knowledge);
}

}  // namespace culprit::diagnose
