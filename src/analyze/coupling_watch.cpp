#include "analyze/coupling_watch.h"

#include <algorithm>

#include "knowledge/ambiguity.h"

namespace culprit {

void CouplingWatch::resolved(const Attempt& attempt, bool is_proven, Time now) {
  const StrategyId strategy = attempt.strategy;
  const RuleId cause = knowledge_.rules[strategy].rule;
  // Some show it before the failure that was repaired does.
  for (const Clearing& clearing : clearings_) {
    if (is_proven && clearing.at >= attempt.first_change && clearing.rule != cause &&
        is_only_cause(strategy, clearing.rule, attempt.first_change))
      knowledge_.couplings.cleared(cause, clearing.rule);
  }
  for (const RuleId effect : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[effect];
    if (effect == cause || state.attempt) continue;
    if (state.failing_since <= attempt.effective) settle(strategy, effect, now);
    if (!is_proven || questions_.size() >= kMostWatched) continue;
    const Time due =
        later(now, std::max(knowledge_.signals.latency(effect), knowledge_.rules.cycle));
    questions_.push_back(
        {strategy, effect, attempt.first_change, state.failing_since, due, later(now, kPatience)});
  }
}

// What depends on the repaired components is given the time to show that it is well. Not what is no
// effect of the failure that is gone: it was detected long before it, or only after the repair had
// taken effect.
void CouplingWatch::settle(StrategyId strategy, RuleId effect, Time now) {
  if (!can_resolve(knowledge_, knowledge_.rules[strategy].components, effect)) return;
  const RuleId cause = knowledge_.rules[strategy].rule;
  RuleState& state = knowledge_.states.state(effect);
  const Duration slack = std::max(knowledge_.signals.latency(cause), knowledge_.rules.cycle);
  if (later(state.failing_since, slack) < knowledge_.states[cause].failing_since) return;
  const Duration latency = std::max(knowledge_.signals.latency(effect), knowledge_.rules.cycle);
  state.settling = {cause, now, later(now, latency)};
}

void CouplingWatch::cleared(RuleId rule, Time now) {
  forget_what_is_settled(now);
  clearings_.push_back({rule, now});
  std::erase_if(questions_, [&](const Question& q) {
    if (q.effect != rule) return false;
    if (is_only_cause(q.strategy, rule, q.since))
      knowledge_.couplings.cleared(knowledge_.rules[q.strategy].rule, rule);
    return true;
  });
}

void CouplingWatch::ended(const Attempt& attempt, Time now) {
  forget_what_is_settled(now);
  if (attempt.first_change != kNever)
    changes_.push_back({attempt.strategy, attempt.first_change, now});
}

void CouplingWatch::advance(Time now) {
  std::erase_if(questions_, [&](Question& q) {
    if (now < q.due) return false;
    const RuleState& state = knowledge_.states[q.effect];
    const bool is_other = state.phase == RulePhase::kQuiet || state.failing_since != q.detected;
    if (is_other || now >= q.abandoned) return true;
    // On its way out, or out of sight: it is asked again.
    if (!state.trigger.known || !state.trigger.b) {
      q.due = later(now, knowledge_.rules.cycle);
      return false;
    }
    if (is_only_cause(q.strategy, q.effect, q.since))
      knowledge_.couplings.stayed(knowledge_.rules[q.strategy].rule, q.effect);
    return true;
  });
}

Time CouplingWatch::next_deadline() const {
  Time next = kNever;
  for (const Question& q : questions_) next = std::min(next, q.due);
  return next;
}

// Can nothing but `strategy` have changed `effect` since then?
bool CouplingWatch::is_only_cause(StrategyId strategy, RuleId effect, Time since) const {
  const auto is_rival = [&](StrategyId other) {
    return other != strategy &&
           (knowledge_.rules[other].rule == effect ||
            can_resolve(knowledge_, knowledge_.rules[other].components, effect));
  };
  for (const Change& change : changes_) {
    if (change.end >= since && is_rival(change.strategy)) return false;
  }
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt && attempt->first_change != kNever && is_rival(attempt->strategy)) return false;
  }
  return true;
}

// Nobody asks about a time before the last `kPatience`, before the first open question and before
// the first attempt under way.
void CouplingWatch::forget_what_is_settled(Time now) {
  Time horizon = now - kPatience;
  for (const Question& q : questions_) horizon = std::min(horizon, q.since);
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt) horizon = std::min(horizon, attempt->first_change);
  }
  std::erase_if(changes_, [&](const Change& change) { return change.end < horizon; });
  std::erase_if(clearings_, [&](const Clearing& clearing) { return clearing.at < horizon; });
}

}  // namespace culprit
