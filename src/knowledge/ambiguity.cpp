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

void mark_ambiguous(Knowledge& knowledge, RuleId changed) {
  Attempt& own = *knowledge.states.state(changed).attempt;
  const auto& own_components = knowledge.rules[own.strategy].components;
  const Sources sources(knowledge, changed);
  for (const RuleId id : knowledge.states.active()) {
    auto& other = knowledge.states.state(id).attempt;
    if (id == changed || !other) continue;
    if (can_resolve(knowledge, own_components, id)) other->is_ambiguous = true;
    const bool has_changed = other->first_change != kNever;
    if (has_changed && sources.have(knowledge.rules[other->strategy].components))
      own.is_ambiguous = true;
  }
}

}  // namespace culprit
