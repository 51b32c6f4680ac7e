// The components that a failure is about.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// The components by which a failure of the rule is explained: those that its strategies adapt, but for
// what only a last resort adapts, or what is only paused for the sake of others: deactivated, and
// activated again later in the same strategy. A rule that only reports is about those that it names,
// or that publish what it reads.
std::vector<ComponentId> touched_by(RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::diagnose
