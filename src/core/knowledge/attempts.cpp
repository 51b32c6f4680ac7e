#include "knowledge/attempts.h"

#include <utility>

#include "base/invariant.h"

namespace culprit {

void Attempts::begin(StrategyId strategy, Time now) {
  const RuleId rule = states_.rules()[strategy].rule;
  auto& slot = states_.slot_of(strategy);
  CULPRIT_ASSERT(!slot);
  slot.emplace();
  slot->strategy = strategy;
  slot->chosen = now;
  slot->has_no_failure = states_[rule].phase == RulePhase::kQuiet;
  // A start beyond all attempts is expected to fail, so its outcome teaches nothing.
  slot->is_ambiguous = states_[rule].search.is_exhausted;
  if (!states_.rules()[strategy].is_last_resort) states_.enter(rule, RulePhase::kAttempting);
}

void Attempts::give_back(StrategyId strategy, Time now) {
  begin(strategy, now);
  of(strategy).stage = Attempt::Stage::kUndoing;
}

void Attempts::resume(StrategyId strategy, Time now) {
  states_.begin_search(states_.rules()[strategy].rule, now);
  begin(strategy, now);
  Attempt& attempt = of(strategy);
  attempt.first_change = now;
  attempt.is_ambiguous = true;
  attempt.has_no_failure = false;
}

void Attempts::change_begins(StrategyId strategy, Time now) {
  Attempt& attempt = of(strategy);
  CULPRIT_ASSERT(attempt.first_change == kNever);  // its first change would not count as its doing
  attempt.first_change = now;
}

void Attempts::took_effect(StrategyId strategy, Time now) {
  Attempt& attempt = of(strategy);
  CULPRIT_ASSERT(attempt.stage == Attempt::Stage::kAdapting);  // an undone change would be judged
  attempt.effective = now;
  attempt.stage = Attempt::Stage::kWaiting;
}

void Attempts::adapts_again(StrategyId strategy) {
  Attempt& attempt = of(strategy);
  attempt.stage = Attempt::Stage::kAdapting;
  attempt.effective = attempt.deadline = kNever;
}

void Attempts::obstruct(StrategyId strategy, std::string obstacle) {
  of(strategy).obstacle = std::move(obstacle);
}

void Attempts::make_ambiguous(StrategyId strategy) { of(strategy).is_ambiguous = true; }

void Attempts::undo(StrategyId strategy) {
  states_.set_tried(strategy, true);
  of(strategy).stage = Attempt::Stage::kUndoing;
}

void Attempts::undone(StrategyId strategy) { of(strategy).stage = Attempt::Stage::kOver; }

Attempt& Attempts::of(StrategyId strategy) {
  auto& attempt = states_.slot_of(strategy);
  CULPRIT_ASSERT(attempt && attempt->strategy == strategy);
  return *attempt;
}

}  // namespace culprit
