// How a process ended, and whether somebody wanted that.
//
// Only the parent of a process receives its exit status. For other processes the kernel shows it,
// too: since Linux 6.15 by the pidfd, and before that only until the parent has received it, which
// is soon. If neither shows it, it is unknown.
#pragma once

#include <string>

#include "robot/observation.h"

namespace culprit::owners {

struct ProcessEnd {
  std::string remark = "ended";  // "exit code 1", "killed by signal 9"
  Cause cause = Cause::kUnknown;
};

// With which Python exits after an exception. A node in Python may raise one because of SIGINT or SIGTERM: its context is
// shut down a second time, or it does not catch ExternalShutdownException.
constexpr int kExceptionInPython = 1;

// SIGINT, SIGTERM, SIGHUP and SIGQUIT are how people and launchers ask; so are the exit codes with
// which programs pass on that it was one of these (130, 143; ros2 run gives 254, 241).
ProcessEnd exited(int code);
ProcessEnd killed(int signal);

// The end of a process that has exited and is not our child. `pidfd` holds it.
ProcessEnd end_of(int pid, int pidfd);

}  // namespace culprit::owners
