// A component that somebody deactivated before a failure of its data, and that the failure's strategy leaves so.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// Does it send nothing of what the rule misses, whatever the strategy does there? A redeploy brings it back to that state, and
// a call or a parameter leaves it there. Not where the rule reads its lifecycle, where it activates itself, or where a group
// has that task.
bool stays_inactive(ComponentId component, const Strategy& strategy, const Knowledge& knowledge);

// Does the rule read the lifecycle of the component?
bool reads_lifecycle(RuleId rule, ComponentId component, const RuleSet& rules);

}  // namespace culprit::diagnose
