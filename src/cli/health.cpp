#include "cli/health.h"

#include <fmt/core.h>

#include "knowledge/describe.h"

namespace culprit::cli {
namespace {

constexpr std::uint8_t kWell = 0;
constexpr std::uint8_t kWarn = 1;
constexpr std::uint8_t kError = 2;

ros2::Health of_rule(RuleId id, const Knowledge& knowledge) {
  const Rule& rule = knowledge.rules[id];
  const RuleState& state = knowledge.states[id];
  ros2::Health health{"culprit: " + rule.name, kWell, "quiet", {}};
  health.values.emplace_back("criticality", std::string(to_string(rule.policies.criticality)));
  switch (state.phase) {
    case RulePhase::kQuiet:
      return health;
    case RulePhase::kFailing:
      health.level = kWarn;
      health.message = "the failure is there";
      break;
    case RulePhase::kAttempting:
      health.level = kWarn;
      health.message = "under repair";
      health.values.emplace_back("strategy", knowledge.rules[state.attempt->strategy].name);
      break;
    case RulePhase::kExhausted:
      health.level = kError;
      health.message = "nothing helped; a person must look";
      break;
  }
  health.values.emplace_back("attempts", std::to_string(state.attempts));
  return health;
}

}  // namespace

std::vector<ros2::Health> health(const Knowledge& knowledge) {
  std::vector<ros2::Health> all{{"culprit", kWell, "all rules are quiet", {}}};
  int failing = 0;
  int exhausted = 0;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    all.push_back(of_rule(RuleId(r), knowledge));
    failing += all.back().level == kWarn ? 1 : 0;
    exhausted += all.back().level == kError ? 1 : 0;
  }
  if (failing + exhausted > 0) {
    all[0].level = exhausted > 0 ? kError : kWarn;
    all[0].message = fmt::format("{} failing, {} exhausted", failing, exhausted);
  }
  all[0].values = {{"rules", std::to_string(knowledge.rules.rules.size())},
                   {"failing", std::to_string(failing)},
                   {"exhausted", std::to_string(exhausted)}};
  return all;
}

}  // namespace culprit::cli
