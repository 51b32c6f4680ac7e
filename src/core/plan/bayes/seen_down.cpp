#include "plan/bayes/seen_down.h"

#include <algorithm>

#include "plan/also_ended.h"

namespace culprit::plan {

bool is_seen_down(ComponentId component, const Knowledge& knowledge) {
  return knowledge.components[component].process != ProcessState::kRunning;
}

bool is_seen_down(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  return std::any_of(strategies.begin(), strategies.end(),
                     [&](StrategyId s) { return revives(knowledge.rules[s], knowledge); });
}

bool replaces(const Strategy& strategy, ComponentId component) {
  return std::any_of(
      strategy.adaptations.begin(), strategy.adaptations.end(), [&](const Adaptation& a) {
        return a.component == component &&
               (a.type == AdaptationType::kRedeploy || a.type == AdaptationType::kStart);
      });
}

bool revives(const Strategy& strategy, const Knowledge& knowledge) {
  return std::any_of(strategy.components.begin(), strategy.components.end(), [&](ComponentId c) {
    return is_seen_down(c, knowledge) && replaces(strategy, c);
  });
}

bool only_revives(const Strategy& strategy, const Knowledge& knowledge) {
  const std::vector<ComponentId> others = also_ended(strategy, knowledge);
  return std::all_of(
             strategy.components.begin(), strategy.components.end(),
             [&](ComponentId c) { return is_seen_down(c, knowledge) && replaces(strategy, c); }) &&
         std::all_of(others.begin(), others.end(),
                     [&](ComponentId c) { return is_seen_down(c, knowledge); });
}

}  // namespace culprit::plan
