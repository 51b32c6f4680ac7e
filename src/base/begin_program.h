// Starts a program that is talked to over descriptors: an argument vector, never a shell of ours.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"

namespace culprit {

// The program's open files: descriptors that are ours to close.
struct ProgramFiles {
  int in = -1;  // -1: nothing is there to read
  int out = -1;
  int err = -1;
  int socket = -1;  // becomes kSocketOfProgram; -1: there is none
};
inline constexpr int kSocketOfProgram = 3;

// The program leads a session and a process group of its own, without a terminal to ask at, gets
// `environment` and nothing else of ours: no open file, no capability, default signal handling.
// `words[0]` is looked for in our PATH if it has no slash. Gives its pid; the caller ends and reaps
// it. Errors: there is no such program, or the system gives no process.
Expected<int> begin_program(std::vector<std::string> words, std::vector<std::string> environment,
                            const ProgramFiles& files);

// As execve(2) takes them, with a null behind. They point into `texts`.
std::vector<char*> pointers_to(std::vector<std::string>& texts);

}  // namespace culprit
