// What earlier processes of culprit did on this robot, as far as it still counts: what they told,
// oldest first.
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
// Events of other kinds say nothing here.
#pragma once

#include <vector>

#include "knowledge/event.h"

namespace culprit {

using History = std::vector<Event>;

}  // namespace culprit
