#include "plan/awaits_valid_strategy.h"

#include <algorithm>

#include "diagnose/timing.h"
#include "knowledge/old_value.h"

namespace culprit::plan {
namespace {

bool brings_back(const Strategy& strategy, ComponentId component) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [&](const Adaptation& a) { return a.component == component && launches(a); });
}

// Is the component a member of a group that the strategy brings up, and out of work with it?
bool brings_up(const Strategy& strategy, ComponentId component, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[component];
  return state.alive == true && state.lifecycle != Lifecycle::kActive &&
         std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
           return a.group && a.component == component;
         });
}

bool may_bring_back(RuleId rule, ComponentId component, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  return std::any_of(strategies.begin(), strategies.end(), [&](StrategyId id) {
    const Strategy& strategy = knowledge.rules[id];
    if (!brings_back(strategy, component)) return false;
    return knowledge.states.awaits_person(rule) || knowledge.states.attempt_of(id) != nullptr ||
           !invalidity(strategy, knowledge);
  });
}

// Its trigger is true, for less than its FOR, say.
bool is_coming(RuleId rule, const Knowledge& knowledge) {
  const Slot& trigger = knowledge.states[rule].detection.trigger;
  return trigger.known && trigger.b && diagnose::may_fire(rule, knowledge);
}

bool is_under_repair(ComponentId component, const Knowledge& knowledge) {
  if (knowledge.components[component].alive.value_or(false)) return false;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const RuleId id(r);
    const bool is_at_work = knowledge.states.is_active(id) || knowledge.states.awaits_person(id) ||
                            is_coming(id, knowledge);
    if (is_at_work && may_bring_back(id, component, knowledge)) return true;
  }
  return false;
}

bool awaits_when(const Strategy& strategy, const Knowledge& knowledge) {
  if (strategy.when.empty()) return false;
  const Slot when = evaluate_when(strategy, knowledge);
  return !when.known || !when.b;
}

// An input about its component's lifecycle or process as the adaptation makes it; empty: it leaves it as it is.
std::optional<Slot> brought_about(const Adaptation& adaptation, const Input& input) {
  if (input.component != adaptation.component) return std::nullopt;
  const bool is_lifecycle = input.kind == Input::Kind::kLifecycle;
  const bool is_alive = input.kind == Input::Kind::kAlive;
  switch (adaptation.type) {
    case AdaptationType::kActivate:
    case AdaptationType::kRestart:
      return is_lifecycle ? std::optional(Slot::of(to_string(Lifecycle::kActive))) : std::nullopt;
    case AdaptationType::kDeactivate:
      return is_lifecycle ? std::optional(Slot::of(to_string(Lifecycle::kInactive))) : std::nullopt;
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
      return is_alive ? std::optional(Slot::of(true)) : std::nullopt;
    case AdaptationType::kStop:
      return is_alive ? std::optional(Slot::of(false)) : std::nullopt;
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return std::nullopt;
}

bool makes_true(const Strategy& strategy, const Program& when, const Knowledge& knowledge) {
  std::vector<Assumed> assumed = without_old_values(when, knowledge);
  for (const Instruction& each : when.code) {
    if (each.op != Op::kInput) continue;
    const InputId input(each.operand);
    std::optional<Slot> value;
    for (const Adaptation& adaptation : strategy.adaptations) {
      if (auto made = brought_about(adaptation, knowledge.rules[input])) value = made;
    }
    if (!value) continue;
    std::erase_if(assumed, [&](const Assumed& old) { return old.input == input; });
    assumed.push_back({input, *value});
  }
  const Slot result = evaluate(when, knowledge.signals.slots(), assumed);
  return result.known && result.b;
}

}  // namespace

bool makes_possible(const Strategy& strategy, const Strategy& waiting, const Invalid& why,
                    const Knowledge& knowledge) {
  if (awaits_when(waiting, knowledge)) return makes_true(strategy, waiting.when, knowledge);
  return brings_up(strategy, why.component, knowledge) ||
         (knowledge.components[why.component].alive == false &&
          brings_back(strategy, why.component));
}

bool awaits_valid_strategy(const Decision& decision, const Knowledge& knowledge) {
  // Rounds in which a strategy was tried count.
  const auto& all = decision.candidates;
  return std::ranges::all_of(
             all, [](const Candidate& c) { return c.excluded == Condition::kInvalid; }) &&
         std::ranges::any_of(all, [&](const Candidate& c) {
           return is_under_repair(c.component, knowledge) ||
                  awaits_when(knowledge.rules[c.strategy], knowledge);
         });
}

}  // namespace culprit::plan
