#pragma once

#include <string>
#include <vector>

namespace culprit::init {

// The ROS package of a program: "/opt/ros/jazzy/lib/usb_cam/usb_cam_node_exe" -> "usb_cam", also
// where an interpreter runs it. Empty if it is not where colcon and Debian put programs of packages.
std::string package_of(const std::vector<std::string>& command);

}  // namespace culprit::init
