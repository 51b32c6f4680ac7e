// What a launch command needs beside its program, as far as the command itself shows it.
//
//   ... --params-file FILE          the file of parameters
//   ros2 run PACKAGE EXECUTABLE     that program, in lib/PACKAGE below one of AMENT_PREFIX_PATH
//   python3 /path/to/script ...     the script
//
// Nothing is guessed: if a form is not among these, nothing is said to be missing.
#pragma once

#include <string>
#include <vector>

#include "owners/spawn.h"

namespace culprit::owners {

// `prefixes`: the value of AMENT_PREFIX_PATH that the program gets; empty: `ros2 run` is not looked at.
std::vector<StartNeed> start_needs(const std::vector<std::string>& arguments,
                                   const std::string& prefixes);

}  // namespace culprit::owners
