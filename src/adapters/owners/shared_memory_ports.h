// The shared memory ports of Fast DDS that killed processes leave behind.
//
// Nodes on one computer send to each other through ports: files in /dev/shm, each with one reader,
// which holds a lock file. A port whose reader does not react for a second counts as broken, and so
// does one whose reader was killed while it worked: a writer then makes a new file of its name. The
// successor of a stopped process takes the same numbers, and its writers go on with files that no
// process reads. It would receive nothing, for good (seen with Fast DDS 2.9).
//
// So culprit keeps the lock files of the processes that it kills: their successors get numbers that no
// writer knows.
#pragma once

#include <cstddef>
#include <deque>

#include "owners/file_descriptor.h"

namespace culprit::owners {

class SharedMemoryPorts {
 public:
  // A process has two. Fast DDS tries a hundred numbers, so most stay free.
  static constexpr std::size_t kMost = 32;

  // The process is about to be killed.
  void note(int pid);
  // Keeps the lock files that no process holds any more. After an exit, and before a start.
  void keep();

 private:
  std::deque<FileDescriptor> noted_;
  std::deque<FileDescriptor> kept_;  // the oldest first
};

}  // namespace culprit::owners
