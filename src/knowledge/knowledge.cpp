#include "knowledge/knowledge.h"

#include <algorithm>

namespace culprit {

Time Knowledge::began(ComponentId component) const {
  Time last = components[component].node_seen;
  for (const ComponentId upstream : graph.upstream(component))
    last = std::max(last, components[upstream].node_seen);
  return last;
}

}  // namespace culprit
