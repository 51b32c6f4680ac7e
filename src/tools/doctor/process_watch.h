// Watches the processes of a robot's nodes, if they are of this machine: their memory and processor
// time from time to time, their command lines, and their launchers.
#pragma once

#include <map>
#include <set>
#include <string>

#include "doctor/picture.h"

namespace culprit::doctor {

class ProcessWatch {
 public:
  // Looks at `nodes` (by name, with their processes) at `at`, and gives the processes that have ended. Cheap: one
  // small file for each.
  std::set<int> sample(const std::map<std::string, int>& nodes, Offset at);

  // All that were there, without those that ended meanwhile.
  const std::map<int, Process>& processes() const { return processes_; }

  // Forgets the samples, not the processes: another look begins.
  void begin_anew();

 private:
  struct Threads {
    std::map<int, Duration> used;  // when they were looked at last
    Offset at{};
  };

  void look_at_threads(int pid, Process& process, Offset at);

  std::map<int, Process> processes_;
  std::map<int, Threads> threads_;  // of those that are busy
};

// Whether the process's output has no reader: its standard output is a pipe that no process reads.
bool has_unread_output(int pid);

// Bytes that new processes may have; 0: not known.
std::int64_t free_memory();

}  // namespace culprit::doctor
