#include "knowledge/awaited_container.h"

#include <algorithm>

namespace culprit {
namespace {

bool replaces(const Strategy& strategy, ComponentId component) {
  return !strategy.is_last_resort &&
         std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
           return a.component == component && launches(a);
         });
}

// Does a strategy replace it, or will one?
bool is_to_be_replaced(ComponentId container, Time ended, const Knowledge& knowledge) {
  const bool is_new = knowledge.now < later(ended, kContainerDetected);
  return std::ranges::any_of(knowledge.rules.strategies, [&](const Strategy& strategy) {
    const RulePhase phase = knowledge.states[strategy.rule].phase;
    const bool is_due = phase == RulePhase::kQuiet ? is_new : phase != RulePhase::kExhausted;
    return is_due && replaces(strategy, container);
  });
}

bool is_being_replaced(ComponentId container, const Knowledge& knowledge) {
  const Attempt* attempt = knowledge.states.reservation(container);
  return attempt != nullptr && attempt->stage == Attempt::Stage::kAdapting &&
         replaces(knowledge.rules[attempt->strategy], container);
}

}  // namespace

std::optional<ComponentId> awaited_container(ComponentId component, const Knowledge& knowledge) {
  const auto container = container_of(component, knowledge.rules);
  if (!container) return std::nullopt;
  const ComponentState& home = knowledge.components[*container];
  const ComponentState& own = knowledge.components[component];
  if (home.known_pid() == 0) return std::nullopt;
  if (is_being_replaced(*container, knowledge)) return container;
  if (home.process != ProcessState::kRunning)
    return is_to_be_replaced(*container, home.process_since, knowledge) ? container : std::nullopt;
  // The component's process has ended, and the report that the container's did follows.
  const bool is_one_process =
      own.process == ProcessState::kGone && own.known_pid() == home.known_pid();
  if (is_one_process)
    return is_to_be_replaced(*container, own.process_since, knowledge) ? container : std::nullopt;
  const Time loaded_by = later(home.process_since, kContainerLoads);
  const bool is_loading = own.in_graph
                              ? own.node_seen >= home.process_since && own.node_seen <= loaded_by &&
                                    knowledge.now < later(own.node_seen, kLoadedSpeaks)
                              : own.process_since < home.process_since && knowledge.now < loaded_by;
  return is_loading ? container : std::nullopt;
}

}  // namespace culprit
