// What may still be tried for a failure whose cause is exhausted?
//
// Everything known against the cause has been tried in vain. Repairing its effects would be in vain
// as well, and would replace processes that are well. So the effects wait for a person together
// with the cause, but for one reconfiguration, once: a strategy that takes nothing down and starts
// nothing. It may get round the cause (another source, another mode).
// The same holds for failures that an unreachable computer explains, and for the effects of a failure
// that waits for a person for another reason, for example because all its remaining strategies were
// refused.
#pragma once

#include "plan/planner.h"

namespace culprit::plan {

// May `strategy` be tried though an exhausted failure explains its own?
bool may_be_tried_beside_exhausted(StrategyId strategy, const Knowledge& knowledge);

// Does the failure wait for a person, together with an exhausted one that explains it, or until a computer
// that explains it is reachable again?
bool waits_for_person(const Decision& decision, const Knowledge& knowledge);

}  // namespace culprit::plan
