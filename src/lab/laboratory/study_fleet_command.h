// culprit study fleet: what a fleet's prior is worth to a new robot.
#pragma once

#include <CLI/CLI.hpp>

namespace culprit::lab {

void add_study_fleet(CLI::App& study, int& exit_code);

}  // namespace culprit::lab
