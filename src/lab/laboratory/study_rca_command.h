// culprit study rca, as a part of culprit study.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace culprit::lab {

// Adds itself to the `study` command, and gives its exit code when it was chosen.
void add_study_rca(CLI::App& study, const std::string& version, int& exit_code);

}  // namespace culprit::lab
