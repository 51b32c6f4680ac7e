#include "plan/cost.h"

namespace culprit::plan {

double cost(Probability success, Cycles impact, Cycles heaviest) {
  return cost_without_impact(success) +
         static_cast<double>(impact.count) / static_cast<double>(heaviest.count);
}

double cost_without_impact(Probability success) { return 1 - success.value; }

}  // namespace culprit::plan
