// A finding of the doctor at a terminal.
#pragma once

#include "doctor/finding.h"
#include "terminal/console.h"

namespace culprit::cli {

void print_finding(const doctor::Finding& finding, Colour colour);

}  // namespace culprit::cli
