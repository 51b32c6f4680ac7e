// The weights of a rule set's strategies, and their timeouts.
//
// The public code knows a constant for each type of adaptation; the paper writes a number at each
// adaptation. Both take the longest of a strategy's adaptations as the time to wait.
#pragma once

#include "language/rule_set.h"
#include "reference/options.h"

namespace culprit::study::reference {

// @pre the table is by type: the reference manager knows the adaptation's type, or it is kRuleFile.
Cycles impact(const Adaptation& adaptation, ImpactTable table);

Cycles sum_of_impacts(const Strategy& strategy, ImpactTable table);
Cycles highest_impact(const Strategy& strategy, ImpactTable table);

}  // namespace culprit::study::reference
