// The files that a launch command needs besides its program, as far as the command shows them.
//
//   ... --params-file FILE          the file of parameters
//   ros2 run PACKAGE EXECUTABLE     that program, in lib/PACKAGE below one of AMENT_PREFIX_PATH
//   python3 /path/to/script ...     the script
//   PACKAGE/FILE.launch.py#NODE     the launch file (launch_file.h)
//
// Other forms are not analysed, so no file of theirs is reported as missing.
#pragma once

#include <string>
#include <vector>

#include "owners/spawn.h"

namespace culprit::owners {

// `prefixes`: the value of AMENT_PREFIX_PATH that the program gets; empty: `ros2 run` is not looked at.
std::vector<StartNeed> start_needs(const std::vector<std::string>& arguments,
                                   const std::string& prefixes);

}  // namespace culprit::owners
