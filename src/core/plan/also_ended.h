// The components that a strategy ends besides those that it is about.
//
// To redeploy or to stop a component is to end its process. With it end the nodes that live in that
// process and those that it started: the other nodes of a launch file, or of a component container.
// They are down as long as the component, so they count as it does, in the cost of the strategy and
// in its conflicts.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

// Ascending, each once, without the components of the strategy itself.
std::vector<ComponentId> also_ended(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
