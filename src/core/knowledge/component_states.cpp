#include "knowledge/component_states.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit {

std::string_view to_string(Lifecycle state) {
  switch (state) {
    case Lifecycle::kUnknown:
      return "unknown";
    case Lifecycle::kUnconfigured:
      return "unconfigured";
    case Lifecycle::kInactive:
      return "inactive";
    case Lifecycle::kActive:
      return "active";
    case Lifecycle::kFinalized:
      return "finalized";
    case Lifecycle::kTransition:
      return "in transition";
  }
  return "";
}

ComponentStates::ComponentStates(const RuleSet& rules)
    : components_(rules.components.size()), parameters_(rules.parameters.size()) {}

void ComponentStates::owe_activation(ComponentId component, Time at) {
  ComponentState& state = components_[component.index];
  const int tries = state.is_to_be_given_back() ? state.brought->tries + 1 : 0;
  state.brought = Brought{Lifecycle::kInactive, false, true, at, tries};
  if (std::ranges::find(owed_, component) == owed_.end()) owed_.push_back(component);
}

void ComponentStates::forget_given_back() {
  std::erase_if(owed_, [&](ComponentId c) { return !components_[c.index].is_to_be_given_back(); });
}

void ComponentStates::set_known_dead(ComponentId component, std::optional<Time> since) {
  std::optional<Time>& known = components_[component.index].known_dead;
  known_dead_ += static_cast<int>(since.has_value()) - static_cast<int>(known.has_value());
  CULPRIT_ASSERT(known_dead_ >= 0);  // the dead would be asked, and their inputs believed
  known = since;
}

void ComponentStates::set_host_silent(ComponentId component, std::optional<Time> since) {
  std::optional<Time>& known = components_[component.index].host_silent;
  unreached_ += static_cast<int>(since.has_value()) - static_cast<int>(known.has_value());
  CULPRIT_ASSERT(unreached_ >= 0);  // what nobody can know would be acted on; below, too
  known = since;
}

void ComponentStates::set_out_of_reach(ComponentId component, bool is_out_of_reach) {
  bool& known = components_[component.index].is_out_of_reach;
  unreached_ += static_cast<int>(is_out_of_reach) - static_cast<int>(known);
  CULPRIT_ASSERT(unreached_ >= 0);
  known = is_out_of_reach;
}

void ComponentStates::set_time_held(ComponentId component, std::optional<Time> since) {
  std::optional<Time>& known = components_[component.index].time_held;
  const int change = static_cast<int>(since.has_value()) - static_cast<int>(known.has_value());
  unreached_ += change;
  times_held_ += change;
  CULPRIT_ASSERT(times_held_ >= 0 && times_held_ <= unreached_);
  known = since;
}

void ComponentStates::intend_lifecycle(ComponentId component, Lifecycle state, Time at,
                                       EventLog& events) {
  ComponentState& of = components_[component.index];
  if (of.intended_lifecycle == state) return;
  of.intended_lifecycle = state;
  of.intended_since = at;
  events.tell(at, LifecycleIntended{component, state});
}

void ComponentStates::note_coming_up(ComponentId component, const ComingUp& how, Time at,
                                     EventLog& events) {
  ComingUp& known = components_[component.index].coming_up;
  if (known == how) return;
  known = how;
  events.tell(at, CameUp{component, how});
}

}  // namespace culprit
