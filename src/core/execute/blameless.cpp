#include "execute/blameless.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "language/evaluate.h"

namespace culprit::execute {
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

}  // namespace

bool is_blameless(ComponentId component, RuleId id, const Knowledge& knowledge) {
  const Rule& rule = knowledge.rules[id];
  std::vector<Assumed> its;
  std::vector<Assumed> of_others;
  for (const InputId read : rule.inputs) {
    const Input& input = knowledge.rules[read];
    const auto best = ideal(input);
    if (!best) continue;
    if (is_of(component, input, knowledge)) {
      its.push_back({read, *best});
    } else if (is_of_another(component, rule, input, knowledge)) {
      of_others.push_back({read, *best});
    }
  }
  if (its.empty() || of_others.empty()) return false;
  const auto is_true_if = [&](const std::vector<Assumed>& assumed) {
    const Slot trigger = evaluate(rule.trigger, knowledge.signals.slots(), assumed);
    return trigger.known && trigger.b;
  };
  return is_true_if(its) && !is_true_if(of_others);
}

}  // namespace culprit::execute
