// Starts a program: an argument vector, never a shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "language/expected.h"

namespace culprit::process {

struct Program {
  std::vector<std::string> arguments;  // the first is the program, with or without a path
  std::vector<std::filesystem::path> search_first;  // where to look for it before PATH
  std::filesystem::path log;               // its output is appended here; parent folders are made
  std::vector<std::string> environment{};  // "NAME=value", beside what it inherits
  // A variable that holds the new process's own pid, and in processes that it starts, not theirs.
  std::string pid_variable{};
};

// The new process leads a session and a process group of its own (a Ctrl-C at culprit's terminal is
// not for it, and it outlives culprit), reads nothing, inherits the environment, no open file and
// no capability that whoever started this program gave it, and has default signal handling.
//
// Gives its pid. The caller reaps it. Errors: no such program, not executable, the log cannot be
// written.
Expected<int> spawn(const Program& program);

// Where `name` would be started from. Errors: it is nowhere, or not executable.
Expected<std::filesystem::path> find_program(
    const std::string& name, const std::vector<std::filesystem::path>& search_first);

}  // namespace culprit::process
