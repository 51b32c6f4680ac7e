// The cost of a strategy before it is chosen (paper, Eq. 1).
//
//     Cost_s = (1 - P_s) + i_exec,s / i_max
//
// Both terms lie in [0, 1]: the chance to fail, and the strategy's impact relative to the heaviest
// in the rule set.
#pragma once

#include "base/units.h"

namespace culprit::plan {

// `success` is the belief's mean; `impact` and `heaviest` are in cycles, heaviest > 0.
double cost(Probability success, Cycles impact, Cycles heaviest);

// The same without the system impact (the paper's ablation without S): what remains is the chance
// to fail.
double cost_without_impact(Probability success);

}  // namespace culprit::plan
