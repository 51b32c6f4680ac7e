// Whether a process of this machine is at work, or would be if the machine had time for it: then it
// does not hang, though it answers no request.
#pragma once

#include <optional>

#include "base/time.h"

namespace culprit::link {

// The time that all threads of the process have had a processor for, or waited for one. Nothing:
// there is no such process, or the kernel does not show it.
std::optional<Duration> processor_time_wanted(int pid);

// One look at a process, to be compared with the next.
struct ProcessorLook {
  int pid = 0;
  Time at{};
  Duration wanted{};
};
std::optional<ProcessorLook> look_at_processor_time(int pid);

// It wanted at least a fifth of a processor between the two looks. A process that only keeps its middleware alive wants
// far less.
bool was_at_work(const ProcessorLook& before, const ProcessorLook& after);

}  // namespace culprit::link
