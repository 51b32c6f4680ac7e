#include "knowledge/ambiguity.h"

#include <algorithm>

namespace culprit {

bool can_resolve(const Knowledge& knowledge, const std::vector<ComponentId>& adapted, RuleId rule) {
  const auto is_adapted = [&](ComponentId c) {
    return std::binary_search(adapted.begin(), adapted.end(), c);
  };
  for (const ComponentId touched : knowledge.rules[rule].components) {
    if (is_adapted(touched)) return true;
    const auto& upstream = knowledge.graph.upstream(touched);
    if (std::any_of(upstream.begin(), upstream.end(), is_adapted)) return true;
  }
  return false;
}

void mark_ambiguous(Knowledge& knowledge, RuleId changed) {
  Attempt& own = *knowledge.states.state(changed).attempt;
  const auto& own_components = knowledge.rules[own.strategy].components;
  for (const RuleId id : knowledge.states.active()) {
    auto& other = knowledge.states.state(id).attempt;
    if (id == changed || !other) continue;
    if (can_resolve(knowledge, own_components, id)) other->is_ambiguous = true;
    const bool has_changed = other->first_change != kNever;
    if (has_changed &&
        can_resolve(knowledge, knowledge.rules[other->strategy].components, changed)) {
      own.is_ambiguous = true;
    }
  }
}

}  // namespace culprit
