#include "execute/component_notes.h"

#include <algorithm>

namespace culprit::execute {

// The component's lifecycle is now where it was brought on purpose.
void ComponentNotes::reached_lifecycle(const Pursuit& pursuit, Time now) {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&pursuit.goal());
  if (lifecycle != nullptr)
    components_.intend_lifecycle(pursuit.component(), lifecycle->target, now, events_);
}

// From now on another state is somebody else's doing. An unproven change may still come.
void ComponentNotes::ended(const Pursuit& pursuit) {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&pursuit.goal());
  if (lifecycle == nullptr || !pursuit.has_changed_anything()) return;
  auto& brought = components_[pursuit.component()].brought;
  const bool is_owed = brought && brought->is_owed;
  if (pursuit.is_reached()) {
    brought = Brought{lifecycle->target};
  } else if (!is_owed) {
    brought.reset();
  }
}

// It stayed unconfigured until a rule had culprit bring it up: it has no other driver.
bool ComponentNotes::is_first_rise(const Pursuit& pursuit) const {
  const auto& before = pursuit.before();
  const auto* state = before ? std::get_if<Lifecycle>(&before->value) : nullptr;
  const auto driver = knowledge_.components[pursuit.component()].coming_up.driver;
  return state != nullptr && *state == Lifecycle::kUnconfigured &&
         driver == ComingUp::Driver::kUnknown;
}

// How long it took, and who brought it up.
void ComponentNotes::came_up(const Pursuit& pursuit, Time now) {
  ComponentState& state = components_[pursuit.component()];
  ComingUp how = state.coming_up;
  if (std::holds_alternative<PresentGoal>(pursuit.goal()) && pursuit.has_changed_anything()) {
    how.joining = now - pursuit.changed();
  } else if (std::holds_alternative<LifecycleGoal>(pursuit.goal())) {
    const bool is_ours = pursuit.has_changed_anything() && !pursuit.met_driver();
    how.driver = is_ours ? ComingUp::Driver::kCulprit : ComingUp::Driver::kOther;
    how.rising = now - (is_ours ? pursuit.first_changed() : state.node_seen);
    if (is_ours) state.culprit_raised = now;
  }
  components_.note_coming_up(pursuit.component(), how, now, events_);
}

// A component that once took too long gets more time at its next start.
void ComponentNotes::took_too_long(const Pursuit& pursuit, Time now) {
  const ComponentState& state = knowledge_.components[pursuit.component()];
  ComingUp how = state.coming_up;
  if (std::holds_alternative<PresentGoal>(pursuit.goal())) {
    how.joining = std::max(how.joining, now - pursuit.changed());
  } else if (std::holds_alternative<LifecycleGoal>(pursuit.goal())) {
    how.rising = std::max(how.rising, now - pursuit.first_changed());
  }
  components_.note_coming_up(pursuit.component(), how, now, events_);
}

// A node may not report a transition before it is over. One that did not even tell its state is not known to begin one: it
// counts as hung as soon as without the request.
void ComponentNotes::sends(const Pursuit& pursuit, const Pursuit::Request& request, Time now) {
  if (!std::holds_alternative<ChangeLifecycle>(request) || !pursuit.before()) return;
  ComponentState& state = components_[pursuit.component()];
  state.transition_patience = std::get<LifecycleGoal>(pursuit.goal()).patience;
  state.changes_until = later(now, state.transition_patience);
}

// Which mode was set, and from which: something else may set it back.
void ComponentNotes::reached_mode(const Pursuit& pursuit, Time now) {
  const auto* mode = std::get_if<ModeGoal>(&pursuit.goal());
  const auto* value = pursuit.before() ? std::get_if<Value>(&pursuit.before()->value) : nullptr;
  const auto* before = value == nullptr ? nullptr : std::get_if<std::string>(value);
  // An odd remark says that it does not read back what was set.
  if (mode == nullptr || before == nullptr || !pursuit.has_changed_anything() ||
      !pursuit.remark().empty())
    return;
  rivals_.changed(pursuit.component(), *before, mode->mode, knowledge_.began(pursuit.component()),
                  now);
}

}  // namespace culprit::execute
