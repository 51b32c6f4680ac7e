#include "diagnose/known_down.h"

#include <algorithm>

namespace culprit::diagnose {

bool is_known_down(ComponentId component, const Knowledge& knowledge) {
  return knowledge.components[component].process != ProcessState::kRunning;
}

std::optional<ComponentId> dead_container_of(ComponentId component, const Knowledge& knowledge) {
  const auto& composed = knowledge.rules[component].composed;
  if (!composed) return std::nullopt;
  const auto container = knowledge.graph.component_of(composed->container);
  const bool is_dead = container && *container != component && is_known_down(*container, knowledge);
  return is_dead ? container : std::nullopt;
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
    return is_known_down(c, knowledge) && !dead_container_of(c, knowledge) && replaces(strategy, c);
  });
}

bool is_known_down(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  return std::any_of(strategies.begin(), strategies.end(),
                     [&](StrategyId s) { return revives(knowledge.rules[s], knowledge); });
}

}  // namespace culprit::diagnose
