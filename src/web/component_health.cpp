#include "web/component_health.h"

#include <algorithm>
#include <iterator>

namespace culprit::web {

std::vector<std::size_t> health_of_components(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<std::size_t> health(rules.components.size());
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (!knowledge.states.has_failure(RuleId(r))) continue;
    const RulePhase phase = knowledge.states[RuleId(r)].phase;
    const std::size_t level =
        phase == RulePhase::kExhausted
            ? std::size(kHealthWords) - 1
            : 1 + static_cast<std::size_t>(rules.rules[r].policies.criticality);
    for (const ComponentId c : rules.rules[r].components)
      health[c.index] = std::max(health[c.index], level);
  }
  return health;
}

}  // namespace culprit::web
