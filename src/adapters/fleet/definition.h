// The effect of a strategy, as a short text. Outcomes of strategies with the same effect are added
// up, in whichever rule file they are, and with whichever numbers.
#pragma once

#include <map>
#include <string>

#include "fleet/tally.h"
#include "language/rule_set.h"

namespace culprit::fleet {

// 16 hexadecimal digits of the hash of all that its adaptations say.
std::string definition_of(const Strategy& strategy, const RuleSet& rules);

// By name, of all strategies.
std::map<StrategyName, std::string> definitions_of(const RuleSet& rules);

}  // namespace culprit::fleet
