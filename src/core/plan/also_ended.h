// What a strategy ends besides the components that it is about.
//
// To redeploy or to stop a component is to end its process, with whatever lives in it and with what
// that started: the other nodes of a launch file, or of a component container. They go down as it
// does, so they count as it does: in what it costs, and in what must not be done meanwhile.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

// Ascending, each once, without the components of the strategy itself.
std::vector<ComponentId> also_ended(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
