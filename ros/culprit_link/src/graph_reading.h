// The graph as the robot's middleware shows it to any of its nodes.
#pragma once

#include <rcl/node.h>

#include "culprit_link/protocol.h"

namespace culprit_link {

// Everything that `node` knows now. Entities whose node is not known yet have an empty node.
GraphSeen read_graph(const rcl_node_t& node);

Quality to_quality(const rmw_qos_profile_t& profile);
rmw_qos_profile_t to_profile(const Quality& quality);

}  // namespace culprit_link
