#include "analyze/known_silence.h"

#include <algorithm>

#include "diagnose/imminent.h"

namespace culprit {
namespace {

bool can_bring_back(const Rule& rule, ComponentId component, const RuleSet& rules) {
  return std::ranges::any_of(rule.strategies, [&](StrategyId id) {
    return std::ranges::any_of(rules[id].adaptations, [&](const Adaptation& a) {
      return a.component == component && launches(a);
    });
  });
}

}  // namespace

KnownSilence::KnownSilence(const Knowledge& knowledge)
    : knowledge_(knowledge),
      is_brought_back_(knowledge.rules.components.size(), false),
      of_silence_(knowledge.rules.rules.size()) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    for (const ComponentId component : rules.rules[r].components) {
      if (can_bring_back(rules.rules[r], component, rules))
        is_brought_back_[component.index] = true;
    }
    for (const InputId input : rules.rules[r].inputs) {
      if (diagnose::after_long_silence(rules[input])) of_silence_[r].push_back(input);
    }
  }
}

std::optional<ComponentId> KnownSilence::behind(RuleId rule) const {
  const auto& state = knowledge_.states[rule];
  if (!knowledge_.components.is_any_known_dead() && !state.detection.known_death)
    return std::nullopt;
  std::optional<ComponentId> dead;
  std::vector<Assumed> assumed;
  for (const InputId input : of_silence_[rule.index]) {
    const auto component = silent_through(knowledge_.rules[input].topic, rule);
    if (!component) continue;
    if (!dead) dead = component;
    assumed.push_back({input, *diagnose::after_long_silence(knowledge_.rules[input])});
  }
  if (!dead) return std::nullopt;
  const Slot value = evaluate(knowledge_.rules[rule].trigger, knowledge_.signals.slots(), assumed);
  return value.known && value.b ? dead : std::nullopt;
}

// The topic's only publisher, if it published since its process began and cannot do so now: it is
// known down, or not received again yet.
std::optional<ComponentId> KnownSilence::silent_through(TopicId topic, RuleId rule) const {
  const auto component = knowledge_.graph.only_publisher(knowledge_.rules[topic]);
  const auto& heard = knowledge_.signals.rhythm(topic).last;
  if (!component || !heard) return std::nullopt;
  const ComponentState& state = knowledge_.components[*component];
  if (state.known_dead)
    return *heard >= state.node_seen && sees(rule, *component) ? component : std::nullopt;
  const auto& before = knowledge_.states[rule].detection.known_death;
  const auto& attempt = knowledge_.states[rule].attempt;
  const bool is_awaited =
      before && before->component == *component && *heard <= before->since && attempt &&
      (!reads_whether_alive(rule, *component) || knowledge_.now < attempt->deadline);
  return is_awaited ? component : std::nullopt;
}

bool KnownSilence::reads_whether_alive(RuleId rule, ComponentId component) const {
  return std::ranges::any_of(knowledge_.rules[rule].inputs, [&](InputId id) {
    const Input& input = knowledge_.rules[id];
    return input.kind == Input::Kind::kAlive && input.component == component;
  });
}

bool KnownSilence::sees(RuleId rule, ComponentId component) const {
  return !is_brought_back_[component.index] ||
         can_bring_back(knowledge_.rules[rule], component, knowledge_.rules);
}

FailureDetected KnownSilence::detected(RuleId rule) const {
  const auto& death = knowledge_.states[rule].detection.known_death;
  const Slot shown = evaluate(knowledge_.rules[rule].trigger, knowledge_.signals.slots());
  if (!death || (shown.known && shown.b)) return {rule};
  const ComponentState& state = knowledge_.components[death->component];
  return {
      rule, death->component,
      state.process == ProcessState::kStopped ? "its process is stopped" : state.process_remark};
}

}  // namespace culprit
