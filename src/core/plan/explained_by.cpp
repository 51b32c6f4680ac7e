#include "plan/explained_by.h"

#include <algorithm>

namespace culprit::plan {

std::vector<RuleId> explained_by(StrategyId strategy, const Knowledge& knowledge) {
  std::vector<bool> is_downstream(knowledge.rules.components.size(), false);
  for (const ComponentId adapted : knowledge.rules[strategy].components) {
    for (const ComponentId c : knowledge.graph.downstream(adapted)) is_downstream[c.index] = true;
  }
  std::vector<RuleId> explained;
  for (const RuleId id : knowledge.states.active()) {
    if (id == knowledge.rules[strategy].rule) continue;
    const auto& touched = knowledge.rules[id].components;
    if (std::any_of(touched.begin(), touched.end(),
                    [&](ComponentId c) { return is_downstream[c.index]; }))
      explained.push_back(id);
  }
  return explained;
}

}  // namespace culprit::plan
