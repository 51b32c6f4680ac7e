// Which nodes of a large robot are asked questions: each question takes two endpoints, which every
// participant of the robot has to discover.
#pragma once

#include <vector>

#include "ros2/graph.h"

namespace culprit::doctor {

// All of up to 60; of more some of each participant, others in each `round`, and at least one.
std::vector<ros2::Graph::NodeView> nodes_to_ask(std::vector<ros2::Graph::NodeView> nodes,
                                                std::size_t round);

}  // namespace culprit::doctor
