#include "analyze/outcome_watch.h"

#include <algorithm>

#include "knowledge/ambiguity.h"

namespace culprit {

void OutcomeWatch::judged(const Attempt& attempt, bool has_helped, Time now) {
  const RuleId rule = knowledge_.rules[attempt.strategy].rule;
  // All was as the strategy would have it: it was not tried.
  const bool changed_nothing = attempt.obstacle.empty() && attempt.first_change == kNever;
  // A rule with ON_CHANGE expects its condition to last: there is nothing to wait for.
  const bool is_at_once = knowledge_.rules[rule].policies.on_change;
  const Time decided = attempt.deadline == kNever ? now : std::max(now, attempt.deadline);
  const auto& active = knowledge_.states.active();
  const bool is_hidden = std::any_of(active.begin(), active.end(), [&](RuleId other) {
    return may_hide(knowledge_, other, rule);
  });
  const PendingOutcome outcome{attempt.strategy, has_helped, now,
                               is_at_once ? now : later(decided, knowledge_.outcomes.healthy),
                               attempt.is_ambiguous || changed_nothing || is_hidden};
  if (outcome.is_void || outcome.due <= now) return count(outcome, now);
  knowledge_.outcomes.open.push_back(outcome);
  knowledge_.tell(now, OutcomePending{attempt.strategy, has_helped, outcome.due});
}

void OutcomeWatch::detected(RuleId rule, Time now) {
  for (PendingOutcome& outcome : knowledge_.outcomes.open) {
    const RuleId own = knowledge_.rules[outcome.strategy].rule;
    outcome.is_back |= own == rule;
    if (own == rule || outcome.judged == now) continue;
    outcome.is_void |= may_hide(knowledge_, rule, own);
    outcome.has_second_fault |= may_bring_back(knowledge_, rule, own);
  }
}

void OutcomeWatch::restart() {
  for (PendingOutcome& outcome : knowledge_.outcomes.open) outcome.is_void = true;
}

void OutcomeWatch::remember(const Event& event) {
  auto& open = knowledge_.outcomes.open;
  if (const auto* pending = std::get_if<OutcomePending>(&event.what)) {
    open.push_back({pending->strategy, pending->has_helped, event.at, pending->due});
  } else if (const auto* counted = std::get_if<OutcomeCounted>(&event.what)) {
    const auto oldest = std::find_if(open.begin(), open.end(), [&](const PendingOutcome& outcome) {
      return outcome.strategy == counted->strategy;
    });
    if (oldest != open.end()) open.erase(oldest);
  } else if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    this->detected(detected->rule, event.at);
  }
}

void OutcomeWatch::advance(Time now) {
  auto& open = knowledge_.outcomes.open;
  for (const PendingOutcome& outcome : open) {
    if (outcome.due <= now) count(outcome, now);
  }
  std::erase_if(open, [&](const PendingOutcome& outcome) { return outcome.due <= now; });
}

void OutcomeWatch::count(const PendingOutcome& outcome, Time now) {
  const RuleId rule = knowledge_.rules[outcome.strategy].rule;
  const bool blames_nobody = outcome.has_helped && outcome.is_back && outcome.has_second_fault;
  if (outcome.is_void || blames_nobody || !knowledge_.states[rule].trigger.known) {
    knowledge_.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kNothing});
  } else if (outcome.has_helped && !outcome.is_back) {
    knowledge_.beliefs.helped(outcome.strategy);
    knowledge_.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kSuccess});
  } else {
    knowledge_.beliefs.did_not_help(outcome.strategy);
    knowledge_.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kFailure});
  }
}

Time OutcomeWatch::next_deadline() const {
  Time next = kNever;
  for (const PendingOutcome& outcome : knowledge_.outcomes.open) next = std::min(next, outcome.due);
  return next;
}

}  // namespace culprit
