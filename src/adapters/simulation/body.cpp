#include "simulation/body.h"

#include "base/invariant.h"

namespace culprit::simulation {

std::optional<Lifecycle> after(Transition transition, Lifecycle state) {
  using enum Lifecycle;
  switch (transition) {
    case Transition::kConfigure:
      return state == kUnconfigured ? std::optional(kInactive) : std::nullopt;
    case Transition::kCleanup:
      return state == kInactive ? std::optional(kUnconfigured) : std::nullopt;
    case Transition::kActivate:
      return state == kInactive ? std::optional(kActive) : std::nullopt;
    case Transition::kDeactivate:
      return state == kActive ? std::optional(kInactive) : std::nullopt;
  }
  return std::nullopt;
}

void Body::start(int new_pid) {
  process = ProcessState::kRunning;
  pid = new_pid;
  is_in_graph = false;
  answers = true;
}

bool Body::end() {
  const bool was_there = process != ProcessState::kGone;
  process = ProcessState::kGone;
  return was_there;
}

bool Body::change(Transition transition) {
  const auto next = after(transition, state);
  if (next) state = *next;
  return next.has_value();
}

const Value* Body::parameter(const std::string& name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? nullptr : &found->second;
}

bool Body::set_parameter(const std::string& name, const Value& value) {
  const auto found = parameters.find(name);
  if (found == parameters.end() || found->second.index() != value.index()) return false;
  found->second = value;
  return true;
}

Answer Body::answer(const decltype(Command::what)& request) {
  CULPRIT_ASSERT(!std::holds_alternative<StartProcess>(request) &&
                 !std::holds_alternative<StopProcess>(request));
  const auto refusal = [](std::string why) {
    return Answer{Outcome::kRefused, {}, std::move(why)};
  };
  if (const auto* lifecycle = std::get_if<ChangeLifecycle>(&request)) {
    if (!change(lifecycle->transition)) return refusal("the transition is not possible");
  } else if (const auto* set = std::get_if<SetParameter>(&request)) {
    if (parameter(set->name) == nullptr) return refusal("no parameter " + set->name);
    if (!set_parameter(set->name, set->value)) return refusal(set->name + " is of another type");
  } else if (const auto* read = std::get_if<ReadParameter>(&request)) {
    const Value* value = parameter(read->name);
    return value != nullptr ? Answer{Outcome::kDone, *value}
                            : refusal("no parameter " + read->name);
  } else if (const auto* wanted = std::get_if<ChangeMode>(&request)) {
    mode = wanted->mode;
  } else if (std::holds_alternative<ReadLifecycle>(request)) {
    return {Outcome::kDone, state};
  } else if (std::holds_alternative<ReadMode>(request)) {
    return {Outcome::kDone, Value(mode)};
  }
  return {};
}

}  // namespace culprit::simulation
