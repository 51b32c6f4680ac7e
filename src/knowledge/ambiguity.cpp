#include "knowledge/ambiguity.h"

#include <algorithm>

namespace culprit {

Sources::Sources(const Knowledge& knowledge, RuleId rule)
    : components_(knowledge.rules[rule].components) {
  for (const ComponentId touched : knowledge.rules[rule].components) {
    const auto& upstream = knowledge.graph.upstream(touched);
    components_.insert(components_.end(), upstream.begin(), upstream.end());
  }
  std::sort(components_.begin(), components_.end());
}

bool Sources::have(const std::vector<ComponentId>& adapted) const {
  return std::any_of(adapted.begin(), adapted.end(), [&](ComponentId c) {
    return std::binary_search(components_.begin(), components_.end(), c);
  });
}

bool can_resolve(const Knowledge& knowledge, const std::vector<ComponentId>& adapted, RuleId rule) {
  return Sources(knowledge, rule).have(adapted);
}

bool is_rival(const Knowledge& knowledge, StrategyId strategy, const Sources& sources,
              RuleId rule) {
  const Strategy& other = knowledge.rules[strategy];
  const bool begins_anew = std::any_of(
      other.adaptations.begin(), other.adaptations.end(), [](const Adaptation& adaptation) {
        using enum AdaptationType;
        return adaptation.type == kRestart || adaptation.type == kRedeploy ||
               adaptation.type == kStart || adaptation.type == kStop;
      });
  const bool is_lesser =
      knowledge.rules[other.rule].policies.criticality < knowledge.rules[rule].policies.criticality;
  return (begins_anew || !is_lesser) && sources.have(other.components);
}

bool is_upstream_of(const Knowledge& knowledge, const std::vector<ComponentId>& components,
                    RuleId rule) {
  const auto& own = knowledge.rules[rule].components;
  const Sources sources(knowledge, rule);
  return std::any_of(components.begin(), components.end(), [&](ComponentId c) {
    return !std::binary_search(own.begin(), own.end(), c) && sources.have({c});
  });
}

void mark_ambiguous(Knowledge& knowledge, RuleId changed) {
  Attempt& own = *knowledge.states.state(changed).attempt;
  const Sources sources(knowledge, changed);
  for (const RuleId id : knowledge.states.active()) {
    auto& other = knowledge.states.state(id).attempt;
    if (id == changed || !other) continue;
    if (is_rival(knowledge, own.strategy, Sources(knowledge, id), id)) other->is_ambiguous = true;
    const bool has_changed = other->first_change != kNever;
    if (has_changed && is_rival(knowledge, other->strategy, sources, changed))
      own.is_ambiguous = true;
  }
}

}  // namespace culprit
