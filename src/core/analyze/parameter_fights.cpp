#include "analyze/parameter_fights.h"

#include <limits>

#include "language/evaluate.h"

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
        bar(*setters.last, own, adaptation.parameter, now);
    }
  }
}

// On which side of what `own` sets the parameter to the strategy pulls it; nothing: it is not known, or it does not set it.
std::optional<bool> ParameterFights::pulls_up(StrategyId id, StrategyId own,
                                              ParameterId parameter) const {
  const auto value = [&](StrategyId strategy) -> std::optional<double> {
    for (const Adaptation& a : knowledge_.rules[strategy].adaptations) {
      if (!syntax::names_parameter(a.type) || a.parameter != parameter) continue;
      if (a.type == AdaptationType::kIncreaseParameter)
        return std::numeric_limits<double>::infinity();
      if (a.type == AdaptationType::kDecreaseParameter)
        return -std::numeric_limits<double>::infinity();
      const Slot set = evaluate(a.value, knowledge_.signals.slots());
      if (!set.known) return std::nullopt;
      if (a.value.type == Type::kDouble) return set.d;
      if (a.value.type == Type::kInt) return static_cast<double>(set.i);
    }
    return std::nullopt;
  };
  const auto other = value(id);
  const auto wanted = value(own);
  if (!other || !wanted || *other == *wanted) return std::nullopt;
  return *other > *wanted;
}

// And all less critical strategies that pull the parameter to the same side.
void ParameterFights::bar(StrategyId loser, StrategyId own, ParameterId parameter, Time now) {
  const RuleSet& rules = knowledge_.rules;
  const Criticality level = rules[rules[own].rule].policies.criticality;
  const auto side = pulls_up(loser, own, parameter);
  states_.bar(loser, {own, now});
  for (std::size_t s = 0; side && s < rules.strategies.size(); ++s) {
    const Strategy& other = rules[StrategyId(s)];
    const bool is_less = rules[other.rule].policies.criticality < level;
    if (is_less && !other.is_last_resort && pulls_up(StrategyId(s), own, parameter) == side)
      states_.bar(StrategyId(s), {own, now});
  }
}

}  // namespace culprit
