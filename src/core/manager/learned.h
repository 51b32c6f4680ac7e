// Learned numbers, as people and the fleet change them.
#pragma once

#include <optional>

#include "knowledge/knowledge.h"

namespace culprit {

// Forgets what was learned about the rule and its strategies; without one, all.
void forget_learned(std::optional<RuleId> rule, Knowledge& knowledge);

// Beliefs begin from the counts of a fleet, and that is told. Invalid counts are left out: they come from a network.
void adopt_priors(const PriorsTold& told, Time now, Knowledge& knowledge);

}  // namespace culprit
