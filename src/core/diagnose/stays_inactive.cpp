#include "diagnose/stays_inactive.h"

#include <algorithm>

#include "diagnose/timing.h"

namespace culprit::diagnose {
namespace {

bool is_of_any_group(ComponentId component, const RuleSet& rules) {
  return std::ranges::any_of(rules.groups, [&](const Group& group) {
    return std::ranges::find(group.members, component) != group.members.end();
  });
}

// Its topics are what the rule misses.
bool is_missed_by(RuleId rule, ComponentId component, const Knowledge& knowledge) {
  return std::ranges::any_of(knowledge.rules[rule].inputs, [&](InputId id) {
    const Input& input = knowledge.rules[id];
    return watches_a_topic(input) &&
           knowledge.graph.publishes(component, knowledge.rules[input.topic]);
  });
}

bool keeps_inactive(const Adaptation& adaptation, const RuleSet& rules) {
  if (adaptation.type == AdaptationType::kRedeploy) return true;
  const bool activates_itself = rules[adaptation.component].lifecycle == LifecycleDriver::kSelf;
  return !activates_itself &&
         (adaptation.type == AdaptationType::kCall || syntax::names_parameter(adaptation.type));
}

}  // namespace

bool reads_lifecycle(RuleId rule, ComponentId component, const RuleSet& rules) {
  return std::ranges::any_of(rules[rule].inputs, [&](InputId id) {
    return rules[id].kind == Input::Kind::kLifecycle && rules[id].component == component;
  });
}

bool stays_inactive(ComponentId component, const Strategy& strategy, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const Time failed = knowledge.states[strategy.rule].failing_since;
  if (!knowledge.components[component].is_inactive_since(failed)) return false;
  bool is_adapted = false;
  for (const Adaptation& each : strategy.adaptations) {
    if (each.component != component) continue;
    is_adapted = true;
    if (!keeps_inactive(each, rules)) return false;
  }
  return is_adapted && is_missed_by(strategy.rule, component, knowledge) &&
         !is_of_any_group(component, rules) && !reads_lifecycle(strategy.rule, component, rules);
}

}  // namespace culprit::diagnose
