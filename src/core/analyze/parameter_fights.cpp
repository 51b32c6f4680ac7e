#include "analyze/parameter_fights.h"

#include <algorithm>

namespace culprit {

ParameterFights::ParameterFights(const Knowledge& knowledge, RuleStates& states)
    : knowledge_(knowledge), states_(states), setters_(knowledge.rules.parameters.size()) {}

void ParameterFights::took_effect(StrategyId strategy) {
  for (const Adaptation& adaptation : knowledge_.rules[strategy].adaptations) {
    if (!syntax::names_parameter(adaptation.type)) continue;
    Setters& setters = setters_[adaptation.parameter.index];
    if (setters.last == strategy) continue;
    setters = {strategy, setters.last, knowledge_.now};
  }
}

void ParameterFights::detected(RuleId rule, Time now) {
  const RuleSet& rules = knowledge_.rules;
  // The failure may be back before the other's change was read back.
  for (const RuleId id : states_.active()) {
    const auto& attempt = states_[id].attempt;
    if (attempt && attempt->first_change != kNever) took_effect(attempt->strategy);
  }
  for (const StrategyId own : rules[rule].strategies) {
    if (rules[own].is_last_resort) continue;
    for (const Adaptation& adaptation : rules[own].adaptations) {
      if (!syntax::names_parameter(adaptation.type)) continue;
      const Setters& setters = setters_[adaptation.parameter.index];
      if (!setters.last || setters.before != own || now >= later(setters.since, kSoon)) continue;
      const RuleId other = rules[*setters.last].rule;
      if (rules[other].policies.criticality < rules[rule].policies.criticality)
        bar_others(own, adaptation.parameter, now);
    }
  }
}

// All less critical strategies that set the parameter: a third one would pull it, too.
void ParameterFights::bar_others(StrategyId own, ParameterId parameter, Time now) {
  const RuleSet& rules = knowledge_.rules;
  const Criticality level = rules[rules[own].rule].policies.criticality;
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    const Strategy& other = rules[StrategyId(s)];
    const bool sets_it = std::ranges::any_of(other.adaptations, [&](const Adaptation& a) {
      return syntax::names_parameter(a.type) && a.parameter == parameter;
    });
    if (sets_it && !other.is_last_resort && rules[other.rule].policies.criticality < level)
      states_.bar(StrategyId(s), {own, now});
  }
}

}  // namespace culprit
