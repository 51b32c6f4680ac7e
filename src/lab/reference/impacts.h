// The weights of a rule set's strategies, and their timeouts.
//
// The public code knows a constant for each type of adaptation, where the paper writes a number at
// each adaptation. Both take the longest of a strategy's adaptations as the time to wait.
#pragma once

#include "language/rule_set.h"

namespace culprit::study::reference {

// @pre the reference manager knows `type` (unsupported.h).
Cycles impact_of(AdaptationType type);

Cycles sum_of_impacts(const Strategy& strategy);
Cycles highest_impact(const Strategy& strategy);

}  // namespace culprit::study::reference
