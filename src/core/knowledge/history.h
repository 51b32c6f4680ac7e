// The events of earlier processes of culprit on this robot, as far as they still count, oldest
// first.
//
//   StrategyChosen, StrategyResumed, OrderAccepted of RunStrategy    what was spent of the budgets
//   FailureDetected, FailureResolved, FailureLost, AdaptationDone    health, launches, cooldowns
//   OutcomePending, OutcomeCounted                                   verdicts that do not count yet
//   StrategyFailed, RoundSpent, LastResortReached, LastResortDone, RuleExhausted     what was tried
//   OrderAccepted of Silence and LiftSilence                         silences
//   ComponentFound                                                   which process it last ran in
//   LifecycleIntended                                                where a new process is brought
//   CameUp                                                           how long it is waited for
//   StaysDown, OrderAccepted of Revive                               what a person ended
//
// Events of other kinds are ignored here.
#pragma once

#include <vector>

#include "knowledge/event.h"

namespace culprit {

using History = std::vector<Event>;

}  // namespace culprit
