// Whether the kernel has frozen a process with its control group, as `systemctl freeze` and `docker pause` have it do.
//
// A frozen process is not stopped by a signal: its state looks as if it slept. SIGKILL ends it in cgroup version 2; in version
// 1 it ends when it is thawed.
#pragma once

#include <vector>

#include "owners/file_descriptor.h"

namespace culprit::owners {

class Freezer {
 public:
  // It keeps to the control groups that the process is in now: a service and a container do not leave theirs.
  explicit Freezer(int pid);

  // Also if a group around it is frozen. False where the kernel shows nothing.
  bool is_frozen() const;

 private:
  std::vector<FileDescriptor> states_;  // cgroup.events (version 2), freezer.state (version 1)
};

}  // namespace culprit::owners
