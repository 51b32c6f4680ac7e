#include "reference/cost.h"

#include <algorithm>

#include "plan/cost.h"
#include "reference/impacts.h"

namespace culprit::study::reference {
namespace {

// By type it is one number; by the rule file it is the highest of the restarts. Rules without any
// keep the paper's scale.
Cycles impact_of_restart(const RuleSet& rules, ImpactTable table, Cycles otherwise) {
  Adaptation restart;
  restart.type = AdaptationType::kRestart;
  if (table != ImpactTable::kRuleFile) return impact(restart, table);
  Cycles highest;
  for (const Strategy& strategy : rules.strategies) {
    for (const Adaptation& adaptation : strategy.adaptations) {
      if (adaptation.type == restart.type) highest = std::max(highest, adaptation.impact);
    }
  }
  return highest.count > 0 ? highest : otherwise;
}

}  // namespace

Costs::Costs(const RuleSet& rules, const ReferenceOptions& options)
    : with_impact_(options.switches.impact), weighted_(options.slips.weighted_cost) {
  Cycles heaviest{1};
  for (const Strategy& strategy : rules.strategies) {
    impacts_.push_back(options.slips.summed_impact ? sum_of_impacts(strategy, options.impacts)
                                                   : highest_impact(strategy, options.impacts));
    heaviest = std::max(heaviest, impacts_.back());
  }
  heaviest_ = heaviest;
  scale_ = static_cast<double>(impact_of_restart(rules, options.impacts, heaviest).count);
}

double Costs::operator()(StrategyId strategy, Probability success) const {
  if (!with_impact_) return plan::cost_without_impact(success);
  const Cycles impact = impacts_[strategy.index];
  if (!weighted_) return plan::cost(success, impact, heaviest_);
  return 0.5 * (1 - success.value) + 0.5 * static_cast<double>(impact.count - 1) / scale_;
}

}  // namespace culprit::study::reference
