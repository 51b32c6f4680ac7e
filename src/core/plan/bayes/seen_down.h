// What the operating system knows to be dead, and what replaces it.
//
// Such a process does not come back by itself, whatever else is repaired, and there is nothing of
// it left that a replacement could disturb. So it is responsible for itself, and waits for nobody.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::plan {

// Is the process of `component` gone or stopped?
bool is_seen_down(ComponentId component, const Knowledge& knowledge);
// Is it that of a component that a strategy of `rule` would replace?
bool is_seen_down(RuleId rule, const Knowledge& knowledge);

// Would the strategy replace the process of `component`?
bool replaces(const Strategy& strategy, ComponentId component);
// Does it replace a process that is seen down? One is enough.
bool revives(const Strategy& strategy, const Knowledge& knowledge);
// Does it replace such processes, and touch nothing else?
bool only_revives(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
