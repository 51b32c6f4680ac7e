// Which names of a robot are no part of it.
#pragma once

#include <string>

namespace culprit {

// What ROS 2 itself publishes, or a tool: "/rosout".
bool is_topic_of_ros(const std::string& topic);

// culprit's own: "/culprit", "/culprit_2".
bool is_culprits_node(const std::string& node);

// What people look with, and what only holds other nodes together: "/rviz", "/launch_ros_4711",
// hidden nodes, and culprit's.
bool is_tool_node(const std::string& node);

}  // namespace culprit
