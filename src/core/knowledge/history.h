// The events of earlier processes of culprit on this robot, as far as they still count, oldest
// first.
//
//   StrategyChosen, StrategyResumed, OrderAccepted of RunStrategy    budgets that were spent
//   FailureDetected, FailureResolved, FailureLost, AdaptationDone    health, launches, cooldowns
//   OutcomePending, OutcomeCounted                                   pending verdicts
//   StrategyFailed, RoundSpent, LastResortReached, LastResortDone, RuleExhausted     attempts
//   OrderAccepted of Silence and LiftSilence                         silences
//   ComponentFound                                                   the process of the last run
//   LifecycleIntended                       the state for a new process, and what a strategy owes
//   CameUp                                                           the patience with its start
//   StaysDown, OrderAccepted of Revive                               what a person ended
//
// Events of other kinds are ignored here.
#pragma once

#include <vector>

#include "knowledge/event.h"

namespace culprit {

using History = std::vector<Event>;

}  // namespace culprit
