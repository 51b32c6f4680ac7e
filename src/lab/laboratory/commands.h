// The subcommands of culprit-lab. Each adds itself to the command line, and gives its exit code
// when it was chosen (terminal/command.h).
#pragma once

#include <string>

#include "terminal/command.h"

namespace CLI {
class App;
}

namespace culprit::lab {

void add_study(CLI::App& app, const std::string& version, int& exit_code);
void add_torture(CLI::App& app, int& exit_code);
void add_play_again(CLI::App& app, int& exit_code);

// Those of `study`.
void add_study_all(CLI::App& study, const std::string& version, int& exit_code);
void add_study_fleet(CLI::App& study, int& exit_code);
void add_study_rca(CLI::App& study, const std::string& version, int& exit_code);
void add_study_rover(CLI::App& study, int& exit_code);
void add_study_suave(CLI::App& study, const std::string& version, int& exit_code);

}  // namespace culprit::lab
