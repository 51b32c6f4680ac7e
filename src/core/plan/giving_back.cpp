#include "plan/giving_back.h"

#include <algorithm>

#include "plan/validity.h"

namespace culprit::plan {
namespace {

bool takes_through_lifecycle(const Strategy& strategy, ComponentId component) {
  return std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
    return a.component == component && !a.group &&
           (a.type == AdaptationType::kRestart || a.type == AdaptationType::kActivate ||
            a.type == AdaptationType::kDeactivate);
  });
}

Time next_try(const Brought& owed) {
  constexpr Duration kFirstPause = std::chrono::seconds(10);
  constexpr Duration kLongestPause = std::chrono::minutes(5);
  if (owed.tries == 0) return owed.since;
  const Duration pause = kFirstPause * (1 << std::min(owed.tries - 1, 10));
  return later(owed.since, std::min<Duration>(pause, kLongestPause));
}

}  // namespace

std::optional<StrategyId> giving_back(ComponentId component, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[component];
  const bool is_due = state.is_to_be_given_back() && state.alive == true &&
                      state.lifecycle == Lifecycle::kInactive &&
                      next_try(*state.brought) <= knowledge.now;
  if (!is_due || knowledge.states.reservation(component) != nullptr) return std::nullopt;
  std::optional<StrategyId> by;
  for (const RuleId rule : knowledge.states.touching(component)) {
    const RuleState& of_rule = knowledge.states[rule];
    const Slot& trigger = of_rule.detection.trigger;
    const bool is_quiet = of_rule.phase == RulePhase::kQuiet && !(trigger.known && trigger.b);
    for (const StrategyId id : knowledge.rules[rule].strategies) {
      const Strategy& strategy = knowledge.rules[id];
      if (!takes_through_lifecycle(strategy, component)) continue;
      if (!is_quiet) return std::nullopt;
      if (!by && !strategy.is_last_resort && !invalidity(strategy, knowledge)) by = id;
    }
  }
  return by;
}

}  // namespace culprit::plan
