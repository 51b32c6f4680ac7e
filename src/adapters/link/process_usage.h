// How much a process uses: the processor, and memory, as /proc has it.
#pragma once

#include <cstdint>
#include <optional>

#include "base/time.h"

namespace culprit::link {

// The processor time that it used since its start, and the memory that it holds now.
struct ProcessUsage {
  Duration processor{};     // of all its threads; not of its children
  double resident_mib = 0;  // memory that is in RAM
};

// Empty if there is no such process, or if it may not be read.
std::optional<ProcessUsage> usage_of(int pid);

// The share of one core that a process used between two looks.
class UsageMeter {
 public:
  // Measures the process, and returns how many cores it used since the measurement before. Empty at the
  // first one of a process, and if the one before is more than a day old. Nor is a short time measured, as
  // between two looks of which the first was late: the kernel counts in steps of 10 ms.
  std::optional<double> look(int pid, const ProcessUsage& usage, Time now);

 private:
  int pid_ = 0;
  Duration processor_{};
  Time at_ = kLongAgo;
};

}  // namespace culprit::link
