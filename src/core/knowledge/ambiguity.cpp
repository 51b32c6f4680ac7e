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
