#include "reference/unsupported.h"

#include <algorithm>

#include "knowledge/describe.h"
#include "knowledge/signal_store.h"

namespace culprit::study::reference {
namespace {

bool is_known(AdaptationType type) {
  using enum AdaptationType;
  return type != kStart && type != kStop && type != kChangeMode && type != kCall;
}

std::optional<Error> in_rule(const Rule& rule) {
  const Policies& policies = rule.policies;
  const bool waits = policies.hold_for > Duration::zero() || policies.cooldown > Duration::zero();
  if (!waits && policies.hold_window <= 1 && !policies.on_change) return std::nullopt;
  return Error{"rule " + rule.name +
               ": the reference manager knows no FOR, HOLD, COOLDOWN and ON_CHANGE; take them out"};
}

std::optional<Error> in_strategy(const Strategy& strategy, const RuleSet& rules) {
  if (!strategy.when.empty())
    return Error{"strategy " + strategy.name +
                 ": the reference manager knows no WHEN; take it out"};
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (!is_known(adaptation.type))
      return Error{"strategy " + strategy.name + ": the reference manager cannot " +
                   describe(adaptation, rules)};
  }
  return std::nullopt;
}

std::optional<Error> in_input(const Input& input, const RuleSet& rules,
                              const ReferenceOptions& options) {
  if (input.kind != Input::Kind::kSignal)
    return Error{"the reference manager reads only signals; write the triggers without functions"};
  const std::string& name = rules[input.signal].name;
  const auto initial = options.initial.find(name);
  if (initial == options.initial.end())
    return Error{"signal " + name + " needs an initial value for the reference manager"};
  std::string text;
  if (!as_type(initial->second, input.type, text).known)
    return Error{"signal " + name + ": its initial value " + to_string(initial->second) +
                 " is no " + std::string(to_string(input.type))};
  return std::nullopt;
}

}  // namespace

std::optional<Error> unsupported(const RuleSet& rules, const ReferenceOptions& options) {
  for (const Rule& rule : rules.rules) {
    if (auto error = in_rule(rule)) return error;
  }
  for (const Strategy& strategy : rules.strategies) {
    if (auto error = in_strategy(strategy, rules)) return error;
  }
  for (const Input& input : rules.inputs) {
    if (auto error = in_input(input, rules, options)) return error;
  }
  for (const auto& [name, value] : options.initial) {
    const bool is_signal =
        std::any_of(rules.signals.begin(), rules.signals.end(),
                    [&, &called = name](const Signal& signal) { return signal.name == called; });
    if (!is_signal) return Error{"the rules have no signal " + name + " to give an initial value"};
  }
  return std::nullopt;
}

}  // namespace culprit::study::reference
