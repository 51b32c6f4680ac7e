// What may be tried of a failure that an exhausted one explains?
//
// All that was known against the cause has been tried in vain, so repairing its effects is in vain
// as well, and each process that is replaced for it was well. They wait for a person with it. What
// may be tried all the same:
//   - one reconfiguration, once: a strategy that takes nothing down and starts nothing. It may lead
//     round the cause (another source, another mode);
//   - a LASTRESORT: the safe stop never waits.
// The same goes for the effects of what a person has to look at for another reason, because all
// that is left was refused, say.
#pragma once

#include "plan/planner.h"

namespace culprit::plan {

// May `strategy` be tried though an exhausted failure explains its own?
bool may_be_tried_beside_exhausted(StrategyId strategy, const Knowledge& knowledge);

// Does the failure wait for a person, together with an exhausted one that explains it?
bool waits_for_person(const Decision& decision, const Knowledge& knowledge);

}  // namespace culprit::plan
