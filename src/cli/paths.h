// Where things are on this machine.
#pragma once

#include <filesystem>
#include <string>

namespace culprit::cli {

// $XDG_STATE_HOME/culprit, or ~/.local/state/culprit.
std::filesystem::path default_state_folder();

// The folder that holds the running program: the exemplars' programs are beside it.
std::filesystem::path own_folder();

// A variable of the environment; empty if it is not set.
std::string environment(const char* name);

}  // namespace culprit::cli
