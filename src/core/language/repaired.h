// Which components a strategy repairs.
#pragma once

#include <vector>

#include "language/rule_set.h"

namespace culprit {

// Adds what the strategy repairs, each once: what it adapts, but for what it only pauses for the sake of others. One
// that does nothing but pause repairs what it pauses; a last resort repairs nothing.
void add_repaired(const Strategy& strategy, std::vector<ComponentId>& to);

}  // namespace culprit
