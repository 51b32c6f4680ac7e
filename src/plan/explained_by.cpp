#include "plan/explained_by.h"

#include <algorithm>

namespace culprit::plan {

std::vector<RuleId> explained_by(StrategyId strategy, const Knowledge& knowledge) {
  std::vector<RuleId> explained;
  for (const RuleId id : knowledge.states.active()) {
    if (id == knowledge.rules[strategy].rule) continue;
    const auto& touched = knowledge.rules[id].components;
    const auto is_downstream = [&](ComponentId adapted) {
      const auto& downstream = knowledge.graph.downstream(adapted);
      return std::any_of(downstream.begin(), downstream.end(), [&](ComponentId c) {
        return std::binary_search(touched.begin(), touched.end(), c);
      });
    };
    const auto& adapted = knowledge.rules[strategy].components;
    if (std::any_of(adapted.begin(), adapted.end(), is_downstream)) explained.push_back(id);
  }
  return explained;
}

}  // namespace culprit::plan
