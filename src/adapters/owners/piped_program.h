// Starts a program that is talked to over its standard input and output: an argument vector, never a
// shell of ours.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

struct Pipe {
  FileDescriptor read_end;
  FileDescriptor write_end;
};
// Not inherited by programs.
Expected<Pipe> make_pipe();

// The program's standard streams: descriptors that are ours to close.
struct Streams {
  int in = -1;  // -1: nothing is there to read
  int out = -1;
  int err = -1;
};

// The program leads a session and a process group of its own, without a terminal to ask at, gets
// `environment` and nothing else of ours: no open file, no capability, default signal handling.
// `words[0]` is looked for in our PATH if it has no slash. Gives its pid; the caller ends and reaps
// it. Errors: there is no such program, or the system gives no process.
Expected<int> begin_piped(std::vector<std::string> words, std::vector<std::string> environment,
                          const Streams& streams);

// The last line of what it printed, of a length to be read; empty: it printed nothing.
std::string last_line(std::string printed);

}  // namespace culprit::owners
