// Where things are on this machine, and what the environment says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/expected.h"

namespace culprit {

// $XDG_STATE_HOME/culprit, or ~/.local/state/culprit.
std::filesystem::path default_state_folder();

// The folder that holds the running program: the exemplars' programs are beside it.
std::filesystem::path own_folder();

// culprit-lab, a program of its own that holds studies, torture and demonstrations: beside the
// running program, or in PATH. Errors: it is in neither.
Expected<std::filesystem::path> find_laboratory();

// How a person calls the program culprit: its name if it is in PATH, else its path if it is beside the running program.
// Empty: it is in neither, as after make demo.
std::string culprit_at_terminal();

// The name of this machine (its host name).
std::string host_name();

// A variable of the environment; empty if it is not set.
std::string environment(const char* name);

// A variable of the environment that the process `pid` was started with. Empty: it was started
// without, there is no such process, or it may not be seen.
std::optional<std::string> environment_of(int pid, const std::string& name);

// "lines" in this variable: progress is printed where there is no terminal, too.
inline constexpr const char* kProgressVariable = "CULPRIT_PROGRESS";

}  // namespace culprit
