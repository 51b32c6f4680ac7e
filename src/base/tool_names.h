// Which names of a robot are no part of it.
#pragma once

#include <string>

namespace culprit {

// Is this a topic that ROS 2 itself or a tool publishes: "/rosout"?
bool is_topic_of_ros(const std::string& topic);

// culprit's own: "/culprit", "/culprit_2".
bool is_culprits_node(const std::string& node);

// The hardware id of what culprit says of itself on /diagnostics.
inline constexpr const char* kCulpritsHardwareId = "culprit";

// A diagnostic status that culprit says of itself, by its name and hardware id.
bool is_culprits_status(const std::string& name, const std::string& hardware_id);

// Is this a node for inspection, or one that only holds other nodes together: "/rviz",
// "/launch_ros_4711", hidden nodes, and culprit's?
bool is_tool_node(const std::string& node);

}  // namespace culprit
