// The shared memory ports of Fast DDS that processes leave behind which did not end in order.
//
// Nodes on one computer send to each other through ports: files in /dev/shm, each with one reader,
// which holds a lock file. A port whose reader does not react for a second counts as broken, and so
// does one whose reader was killed while it worked: a writer then makes a new file of its name. The
// successor of a stopped process takes the same numbers, and its writers go on with files that no
// process reads. It would receive nothing, for good (seen with Fast DDS 2.9).
//
// So culprit locks the lock files that such processes left, also before it began: their successors
// get numbers that no writer knows. A process that ends in order removes its files.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "owners/file_descriptor.h"

namespace culprit::owners {

class SharedMemoryPorts {
 public:
  // A process has two. Fast DDS tries a hundred numbers, so most stay free.
  static constexpr std::size_t kMost = 32;
  static constexpr std::size_t kMostOfEarlier = 16;

  // Keeps the newest of those that processes left before culprit began.
  void keep_earlier();
  // The process has its ports by now, or is about to be killed.
  void note(int pid);
  // The process has exited.
  void keep(int pid);

 private:
  std::map<int, std::vector<std::string>> noted_;  // the lock files of each process
  std::deque<FileDescriptor> kept_;                // the oldest first
};

}  // namespace culprit::owners
