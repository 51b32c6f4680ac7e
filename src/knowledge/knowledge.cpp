#include "knowledge/knowledge.h"

#include <algorithm>

namespace culprit {

void Knowledge::intend_lifecycle(ComponentId component, Lifecycle state, Time at) {
  Lifecycle& intended = components[component].intended_lifecycle;
  if (intended == state) return;
  intended = state;
  tell(at, LifecycleIntended{component, state});
}

Time Knowledge::began(ComponentId component) const {
  Time last = components[component].node_seen;
  for (const ComponentId upstream : graph.upstream(component))
    last = std::max(last, components[upstream].node_seen);
  return last;
}

}  // namespace culprit
