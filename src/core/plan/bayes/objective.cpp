#include "plan/bayes/objective.h"

#include <array>
#include <string>

namespace culprit {
namespace {

constexpr std::array kObjectives = {Objective::kBalanced, Objective::kDowntime,
                                    Objective::kAdaptations, Objective::kRedeployments};

}  // namespace

CostWeights weights(Objective objective) {
  switch (objective) {
    case Objective::kDowntime:
      return {.time = 1, .attempt = 0.01, .redeployment = 0.01, .disruption = 0.05};
    case Objective::kAdaptations:
      return {.time = 0.02, .attempt = 1, .redeployment = 0.02, .disruption = 0.01};
    case Objective::kRedeployments:
      return {.time = 0.02, .attempt = 0.02, .redeployment = 1, .disruption = 0.01};
    case Objective::kBalanced:
      return {.time = 0.5, .attempt = 0.25, .redeployment = 0.5, .disruption = 0.1};
  }
  return {};
}

std::string_view to_string(Objective objective) {
  switch (objective) {
    case Objective::kDowntime:
      return "downtime";
    case Objective::kAdaptations:
      return "adaptations";
    case Objective::kRedeployments:
      return "redeployments";
    case Objective::kBalanced:
      return "balanced";
  }
  return "";
}

Expected<Objective> parse_objective(std::string_view name) {
  std::string known;
  for (const Objective objective : kObjectives) {
    if (to_string(objective) == name) return objective;
    known += (known.empty() ? "" : ", ") + std::string(to_string(objective));
  }
  return Error{"there is no objective '" + std::string(name) + "'; there are " + known};
}

}  // namespace culprit
