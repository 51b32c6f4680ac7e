// Shell completion for a program's command line. It is made from the program's own commands and options, so it is complete and exact. Values are completed
// where their type says what they are (help.h): one of several words ({text,json}), FILE or FOLDER.
//
//     source <(culprit manual --format bash)
//
// The scripts need nothing but their shell: bash 4, zsh with its completion system, fish 3.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "terminal/manual.h"

namespace culprit {

std::string as_bash_completion(const CLI::App& app, const Manual& manual);
std::string as_zsh_completion(const CLI::App& app, const Manual& manual);
std::string as_fish_completion(const CLI::App& app, const Manual& manual);

}  // namespace culprit
