#include "knowledge/held.h"

#include <algorithm>

#include "base/invariant.h"
#include "language/evaluate.h"

namespace culprit {
namespace {

// The members of a group that it brings up are started first if they are down.
bool starts(const Adaptation& a, const Knowledge& knowledge) {
  return launches(a) || (a.group && a.type == AdaptationType::kActivate &&
                         knowledge.components[a.component].alive == false);
}

// A whole number fits a parameter of numbers, so 1 and 1.0 are no different.
std::optional<Value> value_of(const Program& program, const Knowledge& knowledge) {
  if (program.empty()) return std::nullopt;
  const Slot slot = evaluate(program, knowledge.signals.slots());
  if (!slot.known) return std::nullopt;
  return program.type == Type::kInt ? Value(static_cast<double>(slot.i))
                                    : to_value(slot, program.type);
}

// @pre both set one parameter of one component, in whatever way
bool set_same_value(const Adaptation& a, const Adaptation& b, const Knowledge& knowledge) {
  // Otherwise what a last resort holds would be set by another strategy.
  CULPRIT_ASSERT(a.component == b.component && a.subject == b.subject);
  if (a.type != b.type) return false;
  if (a.type == AdaptationType::kChangeCommunication) return a.topic == b.topic;
  if (a.type != AdaptationType::kSetParameter) return false;
  const auto value = value_of(a.value, knowledge);
  return value && value == value_of(b.value, knowledge);
}

template <class Counts>
std::optional<StrategyId> holder(const Adaptation& change, const Knowledge& knowledge,
                                 Counts counts) {
  std::optional<StrategyId> found;
  knowledge.states.for_each_standing([&](StrategyId id) {
    const Strategy& standing = knowledge.rules[id];
    const bool is_held = std::ranges::any_of(standing.adaptations, [&](const Adaptation& held) {
      return changes(change, held, knowledge);
    });
    if (!found && is_held && counts(standing)) found = id;
  });
  return found;
}

}  // namespace

bool changes(const Adaptation& change, const Adaptation& held, const Knowledge& knowledge) {
  if (change.component != held.component) return false;
  switch (held.type) {
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
      return syntax::names_parameter(change.type) && change.subject == held.subject &&
             !set_same_value(change, held, knowledge);
    case AdaptationType::kChangeMode:
      return change.type == AdaptationType::kChangeMode && change.subject != held.subject;
    case AdaptationType::kDeactivate:
      if (launches(change)) return knowledge.components[change.component].alive == true;
      return change.type == AdaptationType::kActivate || change.type == AdaptationType::kRestart;
    case AdaptationType::kActivate:
    case AdaptationType::kRestart:
      return change.type == AdaptationType::kDeactivate ||
             change.type == AdaptationType::kRestart || change.type == AdaptationType::kStop;
    case AdaptationType::kStart:
    case AdaptationType::kRedeploy:
      return change.type == AdaptationType::kStop;
    case AdaptationType::kStop:
      return starts(change, knowledge);
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      return false;
  }
  return false;
}

std::optional<StrategyId> holder_of(const Adaptation& change, const Knowledge& knowledge) {
  return holder(change, knowledge, [](const Strategy&) { return true; });
}

std::optional<StrategyId> holder_against(const Strategy& strategy, const Adaptation& change,
                                         const Knowledge& knowledge) {
  const auto level = [&](const Strategy& s) {
    return knowledge.rules[s.rule].policies.criticality;
  };
  return holder(change, knowledge, [&](const Strategy& standing) {
    const bool is_own = standing.rule == strategy.rule;
    if (strategy.is_last_resort) return !is_own && level(standing) >= level(strategy);
    const bool replaces = launches(change) && knowledge.components[change.component].alive == true;
    return !(is_own && replaces);
  });
}

bool is_inactive_anyway(const ComponentState& state) {
  if (state.alive != true) return state.alive == false && !state.in_graph;
  return state.lifecycle == Lifecycle::kUnconfigured || state.lifecycle == Lifecycle::kFinalized;
}

}  // namespace culprit
