// How a process was started, as the clauses of a COMPONENT.
#pragma once

#include <string>

#include "init/robot_profile.h"

namespace culprit::init {

// LAUNCH "/opt/driver --frame 'left lidar'" ENV "ROS_DOMAIN_ID=7" CWD "/a/folder".
// @pre start.command is not empty
std::string launch_text(const Start& start);

// IN /box PLUGIN cameras::Driver PACKAGE my_cameras PARAMETERS "/a/file.yaml" REMAP "image:=/left/image".
std::string composed_text(const Recipe& recipe, const std::string& parameter_file);

}  // namespace culprit::init
