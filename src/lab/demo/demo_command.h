// culprit-lab demo: culprit heals a live exemplar, for people to look at.
#pragma once

namespace CLI {
class App;
}

namespace culprit::lab {

// Adds itself to the command line, and gives its exit code when it was chosen
// (terminal/command.h).
void add_demo(CLI::App& app, int& exit_code);

}  // namespace culprit::lab
