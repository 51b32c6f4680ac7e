// culprit study all: every study that needs no live robot, one after the other, into a folder.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace culprit::lab {

void add_study_all(CLI::App& study, const std::string& version, int& exit_code);

}  // namespace culprit::lab
