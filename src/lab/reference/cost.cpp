#include "reference/cost.h"

#include "plan/cost.h"
#include "reference/impacts.h"

namespace culprit::study::reference {

Costs::Costs(const RuleSet& rules, const ReferenceOptions& options)
    : with_impact_(options.switches.impact) {
  for (const Strategy& strategy : rules.strategies) impacts_.push_back(sum_of_impacts(strategy));
}

double Costs::operator()(StrategyId strategy, Probability success) const {
  if (!with_impact_) return plan::cost_without_impact(success);
  const auto impact = static_cast<double>(impacts_[strategy.index].count - 1);
  return 0.5 * (1 - success.value) + 0.5 * impact / impact_of(AdaptationType::kRestart).count;
}

}  // namespace culprit::study::reference
