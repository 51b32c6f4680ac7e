// Starts a program that is talked to over its standard input and output: an argument vector, never a
// shell of ours.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
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

// How a program ended, and its output.
struct PipedRun {
  enum class End : std::uint8_t { kItself, kTime, kTooMuch };
  End end = End::kItself;
  int status = 0;  // the exit status; 128 + n after signal n. Of no meaning unless `end` is kItself
  std::string out{};
  std::string err{};  // at most its last quarter of kMostOutput
};
inline constexpr std::size_t kMostOutput = std::size_t{1} << 20;  // bytes

// Runs a program until it ends, or `limit`, or kMostOutput; then it and its group are killed. Errors as
// above.
Expected<PipedRun> run_piped(std::vector<std::string> words, std::vector<std::string> environment,
                             Duration limit);

// The last line of what it printed, of a length to be read; empty: it printed nothing.
std::string last_line(std::string printed);

}  // namespace culprit::owners
