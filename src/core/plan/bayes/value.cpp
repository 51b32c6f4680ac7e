#include "plan/bayes/value.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit::plan {

double weight(Criticality level) { return static_cast<double>(1 << static_cast<int>(level)); }

double time_cost(const Effort& effort, const CostWeights& weights, const RuleSet& rules) {
  const double cycles =
      static_cast<double>(effort.impact.count) + seconds(effort.latency) / seconds(rules.cycle);
  CULPRIT_ASSERT(rules.heaviest.count > 0 && rules.cycle > Duration::zero());
  return weights.time * cycles / static_cast<double>(rules.heaviest.count);
}

double try_cost(const Effort& effort, const CostWeights& weights, const RuleSet& rules) {
  return time_cost(effort, weights, rules) + weights.attempt +
         weights.redeployment * effort.redeployments + weights.disruption * effort.disruption;
}

void StillThere::fails(const Try& tried) {
  const double own = tried.luck < 1 ? (tried.chance - tried.luck) / (1 - tried.luck) : 0;
  left_ = std::max(0.0, left_ - own);
  unlucky_ *= 1 - tried.luck;
}

std::vector<double> expected_costs(std::span<const Try> tries) {
  std::vector<double> expected;
  expected.reserve(tries.size());
  for (std::size_t s = 0; s < tries.size(); ++s) {
    double cost = tries[s].cost;
    StillThere still_there;
    still_there.fails(tries[s]);
    for (std::size_t k = 0; k < tries.size() && still_there.chance() > 0; ++k) {
      if (k == s) continue;
      cost += tries[k].cost * still_there.chance();
      still_there.fails(tries[k]);
    }
    expected.push_back(cost);
  }
  return expected;
}

}  // namespace culprit::plan
