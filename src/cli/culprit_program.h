// The program culprit, but for its main function: that is compiled soon, for CLI11 is not in it.
#pragma once

#include <string>

namespace culprit::cli {

// Runs the command that the command line names, or becomes culprit-lab where that has it. Gives the exit code.
int run_culprit(const std::string& version, int argc, char** argv);

}  // namespace culprit::cli
