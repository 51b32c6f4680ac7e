// Which nodes of a large robot are asked questions: each question takes two endpoints, which every
// participant of the robot has to discover.
#pragma once

#include <vector>

#include "ros2/graph.h"

namespace culprit::doctor {

// All of up to 60. Of more, two of each participant, for the nodes of a process mostly hang together, and those
// that are managed, since only they know their states: 60 in all, but at least one of each participant, and
// others in each `round`.
std::vector<ros2::Graph::NodeView> nodes_to_ask(std::vector<ros2::Graph::NodeView> nodes,
                                                std::size_t round);

}  // namespace culprit::doctor
