#include "manager/learned.h"

#include <utility>

namespace culprit {

void forget_learned(std::optional<RuleId> rule, Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    if (!rule || rules.strategies[s].rule == *rule) knowledge.beliefs.forget(StrategyId(s));
  }
  std::erase_if(knowledge.outcomes.open, [&](const PendingOutcome& outcome) {
    return !rule || rules[outcome.strategy].rule == *rule;
  });
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const RuleId effect(r);
    for (const Couplings::Learned& each : knowledge.couplings.of(effect)) {
      if (!rule || each.cause == *rule || effect == *rule)
        knowledge.couplings.set(each.cause, effect, {});
    }
    if (rule && effect != *rule) continue;
    knowledge.latencies.forget(effect);
    knowledge.transients.forget(effect);
    knowledge.coincidences.forget(effect);
  }
}

void adopt_priors(const PriorsTold& told, Time now, Knowledge& knowledge) {
  PriorsAdopted adopted{{}, told.source};
  constexpr double kMost = 1e9;
  const auto is_count = [](double count) { return count > 0 && count < kMost; };
  for (const PriorsTold::Prior& each : told.priors) {
    if (each.strategy.index >= knowledge.rules.strategies.size()) continue;
    if (!is_count(each.alpha) || !is_count(each.beta)) continue;
    if (knowledge.beliefs.begin_from(each.strategy, {each.alpha, each.beta}))
      adopted.priors.push_back(each);
  }
  if (!adopted.priors.empty()) knowledge.events.tell(now, std::move(adopted));
}

}  // namespace culprit
