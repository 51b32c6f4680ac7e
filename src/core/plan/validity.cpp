#include "plan/validity.h"

#include "language/evaluate.h"

namespace culprit::plan {
namespace {

bool has_lifecycle(Lifecycle state) {
  return state != Lifecycle::kUnknown && state != Lifecycle::kFinalized;
}

bool is_left_alone(const Adaptation& adaptation, const Knowledge& knowledge) {
  if (!knowledge.rivals.is_anything_left_alone()) return false;
  return adaptation.type == AdaptationType::kChangeMode &&
         knowledge.rivals.is_left_alone(adaptation.component,
                                        knowledge.began(adaptation.component));
}

bool is_of_process(AdaptationType type) {
  return type == AdaptationType::kRedeploy || type == AdaptationType::kStart ||
         type == AdaptationType::kStop;
}

bool cannot_be_reached(const Adaptation& adaptation, const Knowledge& knowledge) {
  return knowledge.is_unheard(adaptation.component) ||
         (is_of_process(adaptation.type) &&
          knowledge.components[adaptation.component].is_out_of_reach);
}

// Why `adaptation` is invalid; empty if it is not.
std::string obstacle(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  const bool is_alive = state.alive.value_or(false);
  const Component& component = knowledge.rules[adaptation.component];
  switch (adaptation.type) {
    case AdaptationType::kRedeploy:
      return component.can_start_again() ? "" : "has no LAUNCH command";
    case AdaptationType::kStart:
      if (!component.can_start()) return "has no LAUNCH command";
      return is_alive ? "is there already" : "";
    case AdaptationType::kStop:
      return is_alive || state.known_pid() != 0 ? "" : "is not there";
    default:
      break;
  }
  if (!is_alive) return "is not alive";
  if (is_left_alone(adaptation, knowledge)) return "is set back by something else";
  switch (adaptation.type) {
    case AdaptationType::kActivate:
      if (state.lifecycle == Lifecycle::kActive) return "is active already";
      return has_lifecycle(state.lifecycle) ? "" : "has no known lifecycle state";
    case AdaptationType::kDeactivate:
      return state.lifecycle == Lifecycle::kActive ? "" : "is not active";
    case AdaptationType::kRestart:
      return has_lifecycle(state.lifecycle) ? "" : "has no known lifecycle state";
    case AdaptationType::kChangeCommunication: {
      const auto& value = knowledge.components[adaptation.parameter];
      const bool is_set = value && *value == Value(adaptation.topic);
      return is_set ? "uses " + adaptation.topic + " already" : "";
    }
    default:
      return "";
  }
}

}  // namespace

std::optional<Invalid> invalidity(const Strategy& strategy, const Knowledge& knowledge) {
  const bool is_at_last_resort = knowledge.states[strategy.rule].search.is_at_last_resort;
  if (strategy.is_last_resort != is_at_last_resort) {
    return Invalid{strategy.adaptations.front().component,
                   is_at_last_resort ? "only the last resort is left" : "it is the last resort"};
  }
  if (!strategy.when.empty()) {
    const Slot when = evaluate(strategy.when, knowledge.signals.slots());
    if (!when.known)
      return Invalid{strategy.adaptations.front().component, "its WHEN condition is unknown"};
    if (!when.b)
      return Invalid{strategy.adaptations.front().component, "its WHEN condition is false"};
  }
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    const Adaptation& adaptation = strategy.adaptations[i];
    bool is_changed_before = false;
    for (std::size_t before = 0; before < i; ++before) {
      is_changed_before |= strategy.adaptations[before].component == adaptation.component;
    }
    // What an earlier adaptation of the same strategy brings about is not known yet: start, then
    // set a parameter.
    if (is_changed_before) continue;
    if (cannot_be_reached(adaptation, knowledge))
      return Invalid{adaptation.component, knowledge.why_unheard(adaptation.component), true};
    const std::string reason = obstacle(adaptation, knowledge);
    if (!reason.empty()) {
      return Invalid{adaptation.component,
                     knowledge.rules[adaptation.component].name + " " + reason};
    }
  }
  return std::nullopt;
}

}  // namespace culprit::plan
