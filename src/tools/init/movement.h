// Finds the signals of a robot's movement, and proposes interlocks so that no strategy begins
// meanwhile.
#pragma once

#include <set>
#include <string>

#include "init/draft_names.h"
#include "init/robot_profile.h"

namespace culprit::init {

// The fields of such commands that say how fast; empty if `type` has none, or is no such command.
std::set<std::string> fields_of_movement(const std::string& type);

// INTERLOCK lines as comments, for a person to take; empty if nothing is seen that moves.
std::string interlocks_text(const RobotProfile& seen, Names& names);

}  // namespace culprit::init
