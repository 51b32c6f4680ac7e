// The program culprit-lab, but for its main function, which says which commands it has: that is compiled soon, for CLI11 is
// not in it.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace culprit::lab {

// Runs the command that the command line names, of those that `add_commands` adds. Gives the exit code.
int run_culprit_lab(const std::string& version,
                    const std::function<void(CLI::App& app, int& exit_code)>& add_commands,
                    int argc, char** argv);

}  // namespace culprit::lab
