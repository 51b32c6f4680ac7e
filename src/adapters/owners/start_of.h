// How a process was started, so that it can be started again.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace culprit::owners {

struct Started {
  std::vector<std::string> command;      // argument vector; the program by its whole path
  std::vector<std::string> environment;  // "NAME=value", as it was then
  std::string folder;                    // that it is in now
};

// Nothing: there is no such process, or it may not be looked into, or its program was removed or replaced.
std::optional<Started> start_of(int pid);
// As above, also if its program was removed or replaced.
std::optional<Started> started_as(int pid);

}  // namespace culprit::owners
