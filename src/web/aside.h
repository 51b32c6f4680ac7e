// Long calculations for web clients: done by a process of its own, so that their time, memory and errors do not affect the manager.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "base/temporary_folder.h"

namespace culprit::web {

struct Printed {
  int status = 0;  // that it exited with
  std::string text;
};

// Runs a program of `arguments` with the lowest priority to its end, for so many seconds of the processor at most. It ends
// with the thread that calls this. Errors: it cannot be run, was killed, or took longer.
Expected<Printed> run_aside(std::vector<std::string> arguments, const TemporaryFolder& folder,
                            int most_seconds);

}  // namespace culprit::web
