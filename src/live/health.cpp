#include "live/health.h"

#include <optional>

#include <fmt/core.h>

#include "knowledge/describe.h"
#include "knowledge/presence.h"

namespace culprit::live {
namespace {

constexpr std::uint8_t kWell = 0;
constexpr std::uint8_t kWarn = 1;
constexpr std::uint8_t kError = 2;

link::Health of_rule(RuleId id, const Knowledge& knowledge) {
  const Rule& rule = knowledge.rules[id];
  const RuleState& state = knowledge.states[id];
  link::Health health{"culprit: " + rule.name, kWell, "quiet", {}};
  health.values.emplace_back("criticality", std::string(to_string(rule.policies.criticality)));
  if (const auto& blind = knowledge.blindness[id]) {
    health.level = kWarn;
    health.message = "blind: " + describe(*blind);
    health.values.emplace_back("blind", std::string(culprit::to_string(blind->why)));
  }
  switch (state.phase) {
    case RulePhase::kQuiet:
      return health;
    case RulePhase::kFailing:
      health.level = kWarn;
      health.message = "the failure is there";
      break;
    case RulePhase::kAttempting:
      health.values.emplace_back("strategy", knowledge.rules[state.attempt->strategy].name);
      if (!knowledge.states.has_failure(id)) return health;
      health.level = kWarn;
      health.message = "under repair";
      break;
    case RulePhase::kExhausted:
      health.level = kError;
      health.message = rule.strategies.empty()     ? "a person must look"
                       : state.search.attempts > 0 ? "nothing helped; a person must look"
                                                   : "nothing could be tried; a person must look";
      break;
  }
  health.values.emplace_back("attempts", std::to_string(state.search.attempts));
  return health;
}

// Empty if the component is not REQUIRED, or its state is unknown.
std::optional<link::Health> of_component(ComponentId id, const Knowledge& knowledge) {
  const Component& component = knowledge.rules[id];
  const ComponentState& state = knowledge.components[id];
  if (!component.is_required || (!state.alive && !state.is_missed)) return std::nullopt;
  link::Health health{"culprit: component " + component.name, kWell, "it is there", {}};
  if (state.alive == true) return health;
  health.level = kError;
  health.message = state.is_missed ? "it is REQUIRED and was never seen; a person must look"
                                   : "it is REQUIRED and is not there";
  return health;
}

// No alarm is not health.
void take_back_what_is_not_judged(std::vector<link::Health>& all) {
  for (link::Health& each : all) {
    if (each.level != kWell) continue;
    each.level = kWarn;
    each.message = "not judged: culprit does not receive the robot's messages";
  }
  all[0].level = kError;
  all[0].message = "culprit does not receive the robot's messages; nothing is judged or done";
}

}  // namespace

std::vector<link::Health> health(const Knowledge& knowledge, Reception reception) {
  std::vector<link::Health> all{{"culprit", kWell, "all rules are quiet", {}}};
  int failing = 0;
  int exhausted = 0;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    all.push_back(of_rule(RuleId(r), knowledge));
    const bool is_active = knowledge.states.is_active(RuleId(r));
    failing += is_active && knowledge.states.has_failure(RuleId(r)) ? 1 : 0;
    exhausted += all.back().level == kError ? 1 : 0;
  }
  const std::size_t blind = knowledge.blindness.count();
  if (failing + exhausted > 0) {
    all[0].level = exhausted > 0 ? kError : kWarn;
    all[0].message = fmt::format("{} failing, {} exhausted", failing, exhausted);
    if (blind > 0) all[0].message += fmt::format(", {} blind", blind);
  } else if (knowledge.blindness.is_total()) {
    all[0].level = kWarn;
    all[0].message = "watching nothing: no rule can see";
  } else if (blind > 0) {
    all[0].level = kWarn;
    all[0].message = fmt::format("no failure is seen, {} blind", blind);
  } else if (const auto absence = worst_absence(knowledge)) {
    all[0].level = kWarn;
    all[0].message = "no failure is seen, but " + describe(*absence, knowledge.rules);
  }
  all[0].values = {{"rules", std::to_string(knowledge.rules.rules.size())},
                   {"failing", std::to_string(failing)},
                   {"exhausted", std::to_string(exhausted)},
                   {"blind", std::to_string(blind)}};
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    auto status = of_component(ComponentId(c), knowledge);
    if (!status) continue;
    if (status->level == kError) {
      all[0].level = kError;
      all[0].message += "; " + knowledge.rules.components[c].name + " is missing";
    }
    all.push_back(std::move(*status));
  }
  if (reception == Reception::kLost) take_back_what_is_not_judged(all);
  return all;
}

}  // namespace culprit::live
