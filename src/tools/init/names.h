// Which names of a robot are no part of it.
#pragma once

#include <string>

namespace culprit::init {

// What ROS 2 itself publishes, or a tool: "/rosout".
bool is_of_ros(const std::string& topic);

// What people look with, and what only holds other nodes together: "/rviz", "/launch_ros_4711".
bool is_tool(const std::string& node);

}  // namespace culprit::init
