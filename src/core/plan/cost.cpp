#include "plan/cost.h"

#include "base/invariant.h"

namespace culprit::plan {

double cost(Probability success, Cycles impact, Cycles heaviest) {
  CULPRIT_ASSERT(heaviest.count > 0);  // the costs would have no order
  return cost_without_impact(success) +
         static_cast<double>(impact.count) / static_cast<double>(heaviest.count);
}

double cost_without_impact(Probability success) { return 1 - success.value; }

}  // namespace culprit::plan
