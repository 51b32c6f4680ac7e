// culprit study rover, as a part of culprit study.
#pragma once

#include <CLI/CLI.hpp>

namespace culprit::lab {

// Adds itself to the `study` command, and gives its exit code when it was chosen.
void add_study_rover(CLI::App& study, int& exit_code);

}  // namespace culprit::lab
