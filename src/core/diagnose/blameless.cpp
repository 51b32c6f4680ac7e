#include "diagnose/blameless.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "diagnose/imminent.h"
#include "language/evaluate.h"

namespace culprit::diagnose {
namespace {

// The value of the input while its component works as well as one can; nothing: the input tells of no outage.
std::optional<Slot> ideal(const Input& input) {
  switch (input.kind) {
    case Input::Kind::kAge:
      return Slot::of(Duration::zero());
    case Input::Kind::kRate:
      return Slot::of(std::numeric_limits<double>::infinity());
    case Input::Kind::kPhi:
      return Slot::of(0.0);
    case Input::Kind::kAlive:
      return Slot::of(true);
    default:
      return std::nullopt;
  }
}

bool is_of(ComponentId component, const Input& input, const Knowledge& knowledge) {
  if (input.kind == Input::Kind::kAlive) return input.component == component;
  const Topic& topic = knowledge.rules[input.topic];
  return knowledge.graph.publishes(component, topic) && knowledge.graph.publisher_count(topic) == 1;
}

// Whether the input is of another component that the rule adapts.
bool is_of_another(ComponentId component, const Rule& rule, const Input& input,
                   const Knowledge& knowledge) {
  return std::ranges::any_of(rule.strategies, [&](StrategyId strategy) {
    return std::ranges::any_of(knowledge.rules[strategy].components, [&](ComponentId other) {
      return other != component && is_of(other, input, knowledge);
    });
  });
}

// The values that a component known to be down will show, if its death made the trigger true before they do.
std::vector<Assumed> of_known_death(RuleId rule, const Knowledge& knowledge) {
  std::vector<Assumed> all;
  const auto& death = knowledge.states[rule].detection.known_death;
  if (!death) return all;
  for (const InputId read : knowledge.rules[rule].inputs) {
    const Input& input = knowledge.rules[read];
    const auto silent = after_long_silence(input);
    if (silent && is_of(death->component, input, knowledge)) all.push_back({read, *silent});
  }
  return all;
}

}  // namespace

bool is_blameless(ComponentId component, RuleId id, const Knowledge& knowledge) {
  const Slot& now = knowledge.states[id].detection.trigger;
  if (!now.known || !now.b) return false;
  const RuleSet& rules = knowledge.rules;
  const Rule& rule = rules[id];
  const auto is_its = [&](const Input& input) { return is_of(component, input, knowledge); };
  const auto is_of_others = [&](const Input& input) {
    return !is_its(input) && is_of_another(component, rule, input, knowledge);
  };
  const auto reads_any = [&](auto is_meant) {
    return std::ranges::any_of(
        rule.inputs, [&](InputId read) { return ideal(rules[read]) && is_meant(rules[read]); });
  };
  if (!reads_any(is_its) || !reads_any(is_of_others)) return false;
  const auto is_true_if_well = [&](auto is_meant) {
    std::vector<Assumed> assumed = of_known_death(id, knowledge);
    for (const InputId read : rule.inputs) {
      const auto best = ideal(rules[read]);
      if (!best || !is_meant(rules[read])) continue;
      std::erase_if(assumed, [&](const Assumed& dead) { return dead.input == read; });
      assumed.push_back({read, *best});
    }
    const Slot trigger = evaluate(rule.trigger, knowledge.signals.slots(), assumed);
    return trigger.known && trigger.b;
  };
  return is_true_if_well(is_its) && !is_true_if_well(is_of_others);
}

}  // namespace culprit::diagnose
