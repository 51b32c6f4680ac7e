#include "analyze/outcome_watch.h"

#include <algorithm>

#include "base/invariant.h"
#include "knowledge/ambiguity.h"

namespace culprit {

void OutcomeWatch::judged(const Attempt& attempt, bool has_helped, Time now) {
  const RuleId rule = knowledge_.rules[attempt.strategy].rule;
  // All was as the strategy would have it: it was not tried.
  const bool changed_nothing = attempt.obstacle.empty() && attempt.first_change == kNever;
  // A rule with ON_CHANGE expects its condition to last: there is nothing to wait for.
  const bool is_at_once = knowledge_.rules[rule].policies.on_change;
  const Time decided = attempt.deadline == kNever ? now : std::max(now, attempt.deadline);
  PendingOutcome outcome{attempt.strategy, has_helped, now,
                         is_at_once ? now : later(decided, knowledge_.outcomes.healthy),
                         attempt.is_ambiguous || changed_nothing};
  if (is_at_once || decided <= now) look_at(outcome);
  if (outcome.is_void || outcome.due <= now) return count(outcome, now);
  write_.outcomes.open.push_back(outcome);
  write_.events.tell(now, OutcomePending{attempt.strategy, has_helped, outcome.due});
}

// Not when the verdict comes: one that helped is judged earlier than one that did not.
void OutcomeWatch::look_at(PendingOutcome& outcome) {
  outcome.was_looked_at = true;
  outcome.is_void |= is_hidden(knowledge_, knowledge_.rules[outcome.strategy].rule);
}

void OutcomeWatch::detected(RuleId rule, Time now) {
  for (PendingOutcome& outcome : write_.outcomes.open) {
    const RuleId own = knowledge_.rules[outcome.strategy].rule;
    outcome.is_back |= own == rule;
    if (own == rule || outcome.judged == now) continue;
    if (outcome.was_looked_at) outcome.is_void |= may_hide(knowledge_, rule, own);
    // Whether it brings it back or not: that can be seen only where the strategy had helped.
    outcome.is_void |= may_bring_back(knowledge_, rule, own);
  }
}

void OutcomeWatch::restart() {
  for (PendingOutcome& outcome : write_.outcomes.open) outcome.is_void = true;
}

void OutcomeWatch::host_fell_silent() {
  for (PendingOutcome& outcome : write_.outcomes.open)
    outcome.is_void |=
        knowledge_.unheard_behind(knowledge_.rules[outcome.strategy].rule).has_value();
}

void OutcomeWatch::remember(const Event& event) {
  auto& open = write_.outcomes.open;
  if (const auto* pending = std::get_if<OutcomePending>(&event.what)) {
    open.push_back({pending->strategy, pending->has_helped, event.at, pending->due});
  } else if (const auto* counted = std::get_if<OutcomeCounted>(&event.what)) {
    const auto oldest = std::find_if(open.begin(), open.end(), [&](const PendingOutcome& outcome) {
      return outcome.strategy == counted->strategy;
    });
    if (oldest != open.end()) open.erase(oldest);
  } else if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    this->detected(detected->rule, event.at);
  } else if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    if (!chosen->dry_run)
      void_verdicts_beside(knowledge_, chosen->strategy, event.at, write_.outcomes);
  }
}

void OutcomeWatch::advance(Time now) {
  auto& open = write_.outcomes.open;
  for (PendingOutcome& outcome : open) {
    if (!outcome.was_looked_at && knowledge_.outcomes.deadline(outcome) <= now) look_at(outcome);
    if (outcome.due <= now) count(outcome, now);
  }
  std::erase_if(open, [&](const PendingOutcome& outcome) { return outcome.due <= now; });
}

void OutcomeWatch::count(const PendingOutcome& outcome, Time now) {
  CULPRIT_ASSERT(outcome.is_void || outcome.due <= now);  // it would teach before it is proven
  const RuleId rule = knowledge_.rules[outcome.strategy].rule;
  if (outcome.is_void || !knowledge_.states[rule].detection.trigger.known) {
    write_.events.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kNothing});
  } else if (outcome.has_helped && !outcome.is_back) {
    write_.beliefs.helped(outcome.strategy);
    write_.events.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kSuccess});
  } else {
    write_.beliefs.did_not_help(outcome.strategy);
    write_.events.tell(now, OutcomeCounted{outcome.strategy, OutcomeCounted::As::kFailure});
  }
}

Time OutcomeWatch::next_deadline() const {
  Time next = kNever;
  const PendingOutcomes& outcomes = knowledge_.outcomes;
  for (const PendingOutcome& outcome : outcomes.open)
    next = std::min(next, outcome.was_looked_at ? outcome.due : outcomes.deadline(outcome));
  return next;
}

}  // namespace culprit
