// The base of every program of the project with subcommands.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace culprit {

// Parses the command line and runs the command that it names. `add_commands` adds the commands to
// `app`, each of which puts its exit code into the integer. Gives the program's exit code. A report
// that a full disk cut short does not count as written.
int run_program(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                char** argv);

// For a command that has much to destroy: ends the program as run_program() does, but destroys
// nothing, since the system takes all memory back at once.
[[noreturn]] void end_program(int exit_code);

}  // namespace culprit
