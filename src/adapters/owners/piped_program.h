// Runs a program and reads what it prints (base/begin_program.h).
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
