// A finding of the doctor at a terminal.
#pragma once

#include <string>

#include "doctor/finding.h"
#include "terminal/console.h"

namespace culprit::cli {

// Names and texts of the robot, and of recordings, are escaped: they may steer a terminal.
std::string finding_text(const doctor::Finding& finding, Colour colour);
void print_finding(const doctor::Finding& finding, Colour colour);

}  // namespace culprit::cli
