// The launch command of each component as a program that can be started: with its mark, its environment, its log, and the
// lock that only one culprit of this machine can hold.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "language/rule_set.h"
#include "owners/file_descriptor.h"
#include "owners/spawn.h"

namespace culprit::owners {

struct ComponentPrograms {
  const RuleSet& rules;
  std::filesystem::path log_folder;  // on this machine: a remote file system could hang
  std::vector<std::filesystem::path> search_first;  // for launch commands without a path
  // Which robot, of all on this machine: "0/sunset". Empty: nothing is marked.
  std::string robot;
  Lifetime lifetime = Lifetime::kOwn;  // of what is started
  // The variables of each component beside the inherited ones; components that have none may be left out. Errors: they
  // could not be determined.
  std::vector<Expected<std::vector<std::string>>> environments;

  std::string mark(ComponentId component) const { return robot + "/" + rules[component].name; }
  // Without its ending: "0-sunset-camera". Robots of one machine may share the folder.
  std::filesystem::path file_of(ComponentId component) const;
  std::filesystem::path log(ComponentId component) const;
  Expected<std::vector<std::string>> environment(ComponentId component) const;
  // `launcher`: the launcher whose process it stands in for; 0: none.
  Program program(ComponentId component, int launcher) const;

  // From the decision to start until the program runs, and carries the mark, no other culprit of the robot may start it. The kernel
  // releases the lock when the last process that holds it has ended or runs the program. Errors: for people.
  Expected<FileDescriptor> lock_start(ComponentId component) const;
};

}  // namespace culprit::owners
