// One operating-system process, held by a pidfd so that its number cannot come to mean another
// process.
#pragma once

#include <string>

#include "language/expected.h"
#include "process/file_descriptor.h"
#include "robot/observation.h"

namespace culprit::process {

enum class Relation : std::uint8_t {
  kChild,   // we started it: we reap it and learn how it ended
  kAdopted  // it was there
};

class WatchedProcess {
 public:
  // Errors: there is no such process, or it may not be watched.
  static Expected<WatchedProcess> watch(int pid, Relation relation);

  int pid() const { return pid_; }
  // Readable when the process has ended.
  int descriptor() const { return pidfd_.get(); }

  // Running or stopped; kGone if it has ended.
  ProcessState state() const;

  // To the process, and to its whole process group if it leads one.
  void signal(int number) const;

  // @pre the process has ended. Reaps a child. In words: "exit code 1", "killed by signal 9",
  // "ended".
  std::string reap();

  // Ends what is left of the process group that it led: it may have started others.
  void kill_group() const;

 private:
  WatchedProcess(int pid, FileDescriptor pidfd, Relation relation, bool leads_group)
      : pid_(pid), pidfd_(std::move(pidfd)), relation_(relation), leads_group_(leads_group) {}

  int pid_;
  FileDescriptor pidfd_;
  Relation relation_;
  bool leads_group_;
};

}  // namespace culprit::process
