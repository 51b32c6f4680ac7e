#include "plan/beside_exhausted.h"

#include <algorithm>

namespace culprit::plan {
namespace {

bool reconfigures(const Adaptation& adaptation) {
  switch (adaptation.type) {
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kDeactivate:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
    case AdaptationType::kCall:  // which may reset what works
      return false;
    case AdaptationType::kActivate:
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kStartGroup:
      break;
  }
  return true;
}

bool reconfigures(const Strategy& strategy) {
  return std::all_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) { return reconfigures(a); });
}

}  // namespace

bool may_be_tried_beside_exhausted(StrategyId strategy, const Knowledge& knowledge) {
  const Strategy& asked = knowledge.rules[strategy];
  const RuleState& state = knowledge.states[asked.rule];
  // A round is spent as well if nothing in it made sense, and nothing was tried.
  const bool may_have_been_tried = state.search.round > 0 && state.search.attempts > 0;
  if (!reconfigures(asked) || may_have_been_tried) return false;
  const auto& all = knowledge.rules[asked.rule].strategies;
  return std::none_of(all.begin(), all.end(), [&](StrategyId other) {
    return knowledge.states.is_tried(other) && reconfigures(knowledge.rules[other]);
  });
}

bool waits_for_person(const Decision& decision, const Knowledge& knowledge) {
  const auto is_out = [](const Candidate& c) {
    return c.excluded == Condition::kTried || c.excluded == Condition::kInvalid;
  };
  const auto waits = [&](const Candidate& c) {
    return c.excluded == Condition::kUnheard ||
           (c.excluded == Condition::kDependency && c.failure &&
            knowledge.states.awaits_person(*c.failure));
  };
  const auto& all = decision.candidates;
  return std::any_of(all.begin(), all.end(), waits) &&
         std::all_of(all.begin(), all.end(),
                     [&](const Candidate& c) { return is_out(c) || waits(c); });
}

}  // namespace culprit::plan
