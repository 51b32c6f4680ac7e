// Which nodes of a large robot are asked questions: each question takes two endpoints, which every
// participant of the robot has to discover.
#pragma once

#include <vector>

#include "ros2/graph.h"

namespace culprit::doctor {

// Up to 60 nodes: all of them. If there are more, one of each participant, for the nodes of a process mostly hang together. Beside those, up to 60 in all, the
// lifecycle nodes, since only they know their states. Others in each `round`.
std::vector<ros2::Graph::NodeView> nodes_to_ask(std::vector<ros2::Graph::NodeView> nodes,
                                                std::size_t round);

}  // namespace culprit::doctor
