#include "diagnose/imminent.h"

#include <algorithm>

#include "diagnose/timing.h"
#include "language/evaluate.h"

namespace culprit::diagnose {
namespace {

using Kind = Input::Kind;

bool reads_topic(const Input& input) {
  return input.kind == Kind::kRate || input.kind == Kind::kAge || input.kind == Kind::kPhi;
}

// With HOLD one reading proves little.
bool is_coming(const RuleState& state, const Policies& policies) {
  if (state.detection.history.empty())
    return state.detection.trigger.known && state.detection.trigger.b;
  return 2 * state.detection.true_in_history > policies.hold_needed;
}

// Will a silence that goes on have reached what the input is compared with while that is waited for?
bool comes_in_time(const Input& input, const Knowledge& knowledge) {
  Duration needs{};
  if (input.kind == Kind::kRate) needs = input.window;
  if (input.kind == Kind::kAge && !input.thresholds.empty())
    needs = from_seconds(input.thresholds.back());
  const Time since = knowledge.signals.rhythm(input.topic).silent_since();
  return later(since, needs) <= later(knowledge.now, kLongestEvidence);
}

bool fires_if_silence_lasts(RuleId rule, const Knowledge& knowledge) {
  std::vector<Assumed> assumed;
  for (const InputId id : knowledge.rules[rule].inputs) {
    const Input& input = knowledge.rules[id];
    if (!reads_topic(input) || !is_silent(input.topic, knowledge.now, knowledge) ||
        !comes_in_time(input, knowledge))
      continue;
    if (const auto value = after_long_silence(input)) assumed.push_back({id, *value});
  }
  if (assumed.empty()) return false;
  const Slot value = evaluate(knowledge.rules[rule].trigger, knowledge.signals.slots(), assumed);
  return value.known && value.b;
}

bool nears_its_threshold(RuleId rule, const Knowledge& knowledge) {
  const auto& inputs = knowledge.rules[rule].inputs;
  return std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
    return knowledge.rules[id].kind == Kind::kSignal && knowledge.signals.is_unusual(id);
  });
}

}  // namespace

std::optional<Slot> after_long_silence(const Input& input) {
  switch (input.kind) {
    case Kind::kRate:
      return Slot::of(0.0);
    case Kind::kAge:
      if (!input.only_compared || input.thresholds.empty()) return std::nullopt;
      return Slot::of(from_seconds(input.thresholds.back()) + Duration(1));
    case Kind::kPhi:
      if (!input.only_compared || input.thresholds.empty()) return std::nullopt;
      return Slot::of(input.thresholds.back() + 1);
    default:
      return std::nullopt;
  }
}

bool is_held_by_cooldown(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  const Time longest = later(knowledge.now, kLongestCooldown);
  return state.phase == RulePhase::kQuiet && knowledge.now < state.quiet_until &&
         state.quiet_until <= longest && is_coming(state, knowledge.rules[rule].policies);
}

bool is_imminent(RuleId rule, const Knowledge& knowledge) {
  if (is_held_by_cooldown(rule, knowledge)) return true;
  if (!may_fire(rule, knowledge)) return false;
  return is_coming(knowledge.states[rule], knowledge.rules[rule].policies) ||
         fires_if_silence_lasts(rule, knowledge) || nears_its_threshold(rule, knowledge);
}

std::vector<RuleId> imminent_rules(const Knowledge& knowledge) {
  std::vector<RuleId> all;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    if (is_imminent(RuleId(r), knowledge)) all.emplace_back(r);
  }
  return all;
}

}  // namespace culprit::diagnose
