// One operating-system process, held by a pidfd so that its number cannot come to mean another
// process.
#pragma once

#include <string>

#include "base/expected.h"
#include "owners/file_descriptor.h"
#include "owners/freezer.h"
#include "owners/process_end.h"
#include "robot/observation.h"

namespace culprit::owners {

enum class Relation : std::uint8_t {
  kChild,   // we started it: we reap it and learn how it ended
  kMarked,  // an earlier culprit started it, as its mark proves
  kAdopted  // somebody else's
};

class WatchedProcess {
 public:
  // Errors: there is no such process, or it may not be watched.
  static Expected<WatchedProcess> watch(int pid, Relation relation);

  int pid() const { return pid_; }
  // Readable when the process has ended.
  int descriptor() const { return pidfd_.get(); }

  // Running, or stopped by a signal or frozen; kGone if it has ended.
  ProcessState state() const;
  bool is_frozen() const { return freezer_.is_frozen(); }

  // To the process, and to the whole process group that it got from us. The group of somebody
  // else's process is somebody else's.
  void signal(int number) const;

  // @pre the process has ended. Reaps a child.
  ProcessEnd reap();

  // Ends what is left of the process group that it got from us: it may have started others.
  // @pre it is not reaped
  void kill_group() const;

  Relation relation() const { return relation_; }

 private:
  WatchedProcess(int pid, FileDescriptor pidfd, Relation relation);
  void signal_group(int number) const;

  int pid_;
  FileDescriptor pidfd_;
  Freezer freezer_;
  Relation relation_;
  bool is_reaped_ = false;
  std::string mark_;  // of kMarked: what its group has in its environment
};

}  // namespace culprit::owners
