// Failures that are expected to clear with a strategy that is meant for another one.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

// The active failures of components that depend on what `strategy` adapts, ascending, its own left
// out.
std::vector<RuleId> explained_by(StrategyId strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
