#include "knowledge/ambiguity.h"

#include <algorithm>

namespace culprit {

namespace {

// Marks these components, and the ones that the search found from them.
std::vector<bool> marked(const Knowledge& knowledge, const std::vector<ComponentId>& components,
                         const std::vector<ComponentId>& found) {
  std::vector<bool> is_marked(knowledge.rules.components.size(), false);
  for (const ComponentId c : components) is_marked[c.index] = true;
  for (const ComponentId c : found) is_marked[c.index] = true;
  return is_marked;
}

bool is_any(const std::vector<ComponentId>& components, const std::vector<bool>& is_marked) {
  return std::any_of(components.begin(), components.end(),
                     [&](ComponentId c) { return is_marked[c.index]; });
}

bool calls(const Strategy& strategy) {
  return std::ranges::any_of(strategy.adaptations, [](const Adaptation& adaptation) {
    return adaptation.type == AdaptationType::kCall;
  });
}

// Does it do more than reconfigure something, for a rule that is less critical than `rule`? A call may mend
// what is wrong.
bool weighs_on(const Knowledge& knowledge, StrategyId strategy, RuleId rule) {
  const Strategy& other = knowledge.rules[strategy];
  const bool is_lesser =
      knowledge.rules[other.rule].policies.criticality < knowledge.rules[rule].policies.criticality;
  return begins_anew(other) || calls(other) || !is_lesser;
}

}  // namespace

Sources::Sources(const Knowledge& knowledge, RuleId rule)
    : is_source_(marked(knowledge, knowledge.rules[rule].components,
                        knowledge.graph.upstream(knowledge.rules[rule].components))) {}

bool Sources::have(const std::vector<ComponentId>& adapted) const {
  return is_any(adapted, is_source_);
}

Effects::Effects(const Knowledge& knowledge, const std::vector<ComponentId>& adapted)
    : is_reached_(marked(knowledge, adapted, knowledge.graph.downstream(adapted))) {}

bool Effects::reach(const Rule& rule) const { return is_any(rule.components, is_reached_); }

bool can_resolve(const Knowledge& knowledge, const std::vector<ComponentId>& adapted, RuleId rule) {
  return Sources(knowledge, rule).have(adapted);
}

bool begins_anew(const Strategy& strategy) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& adaptation) {
                       using enum AdaptationType;
                       return adaptation.type == kRestart || adaptation.type == kRedeploy ||
                              adaptation.type == kStart || adaptation.type == kStop;
                     });
}

bool is_rival(const Knowledge& knowledge, StrategyId strategy, const Sources& sources,
              RuleId rule) {
  return weighs_on(knowledge, strategy, rule) && sources.have(knowledge.rules[strategy].components);
}

bool is_rival(const Knowledge& knowledge, StrategyId strategy, const Effects& effects,
              RuleId rule) {
  return weighs_on(knowledge, strategy, rule) && effects.reach(knowledge.rules[rule]);
}

bool may_bring_back(const Knowledge& knowledge, RuleId other, RuleId rule) {
  const Rule& theirs = knowledge.rules[other];
  const Rule& ours = knowledge.rules[rule];
  if (theirs.policies.criticality < ours.policies.criticality) return false;
  const Sources sources(knowledge, rule);
  return std::any_of(theirs.components.begin(), theirs.components.end(), [&](ComponentId c) {
    return !std::binary_search(ours.components.begin(), ours.components.end(), c) &&
           sources.have({c});
  });
}

bool may_hide(const Knowledge& knowledge, RuleId other, RuleId rule) {
  const Rule& theirs = knowledge.rules[other];
  const Rule& ours = knowledge.rules[rule];
  return theirs.policies.criticality > ours.policies.criticality &&
         (can_resolve(knowledge, theirs.components, rule) ||
          can_resolve(knowledge, ours.components, other));
}

bool is_hidden(const Knowledge& knowledge, RuleId rule) {
  const auto& active = knowledge.states.active();
  return std::any_of(active.begin(), active.end(),
                     [&](RuleId other) { return may_hide(knowledge, other, rule); });
}

void void_verdicts_beside(const Knowledge& knowledge, StrategyId strategy, Time at,
                          PendingOutcomes& outcomes) {
  if (outcomes.open.empty()) return;
  const Effects effects(knowledge, knowledge.rules[strategy].components);
  for (PendingOutcome& outcome : outcomes.open) {
    const RuleId rule = knowledge.rules[outcome.strategy].rule;
    if (rule != knowledge.rules[strategy].rule && at < outcomes.deadline(outcome))
      outcome.is_void |= is_rival(knowledge, strategy, effects, rule);
  }
}

void mark_ambiguous(const Knowledge& knowledge, StrategyId changed, Attempts& attempts,
                    PendingOutcomes& outcomes) {
  const RuleId rule = knowledge.rules[changed].rule;
  void_verdicts_beside(knowledge, changed, knowledge.states.attempt_of(changed)->first_change,
                       outcomes);
  const Sources sources(knowledge, rule);
  const Effects effects(knowledge, knowledge.rules[changed].components);
  for (const RuleId id : knowledge.states.active()) {
    const RuleState& state = knowledge.states[id];
    const bool is_beside = id == rule && knowledge.rules[changed].is_last_resort;
    const bool is_another = id != rule && is_rival(knowledge, changed, effects, id);
    if (state.attempt && (is_beside || is_another))
      attempts.make_ambiguous(state.attempt->strategy);
    for (const auto* other : {&state.attempt, &state.last_resort}) {
      if (id == rule || !*other || (*other)->first_change == kNever) continue;
      if (is_rival(knowledge, (*other)->strategy, sources, rule)) attempts.make_ambiguous(changed);
    }
  }
}

}  // namespace culprit
