// The cost that a robot's owner most wants to avoid: how much each kind of cost weighs
// (docs/planning.md).
//
// A weight is what one unit of the cost is worth, where resolving a NON_CRITICAL failure is worth
// 1:
//   time           the heaviest strategy's impact (paper: i_max) once more without the failure gone
//   attempt        one strategy executed
//   redeployment   one process replaced
//   disruption     the whole robot taken down for a moment
//
// Under every objective each of them weighs something: among strategies with equal main cost, the
// one that is better in the rest is taken.
#pragma once

#include <string_view>

#include "base/expected.h"

namespace culprit {

enum class Objective : std::uint8_t { kDowntime, kAdaptations, kRedeployments, kBalanced };

struct CostWeights {
  double time = 0;
  double attempt = 0;
  double redeployment = 0;
  double disruption = 0;
};
CostWeights weights(Objective objective);

// "downtime", "adaptations", "redeployments", "balanced"
std::string_view to_string(Objective objective);
// An error says which there are.
Expected<Objective> parse_objective(std::string_view name);

}  // namespace culprit
