// Signals for what a process of ours has started, in whatever session and group it is: it holds the devices that the
// successor needs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/time.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

void send_signal(const FileDescriptor& process, int signal);

// The process of that number and that start (proc.h), held so that the number cannot come to mean another one. Empty: it has ended.
FileDescriptor hold(int pid, std::int64_t start_ticks);

// Sends the signal to the descendants of the process that are not in its group, and returns all of them. They are found
// by their parents, also if they have cleared their environment. Not those of another component, for example if the
// process is a culprit of its own. `variable`: what the process has in its environment (mark.h).
std::vector<FileDescriptor> signal_descendants(int pid, const std::string& variable, int signal);

// Kills the processes that carry the mark and were left by the process with this variable. It may start others meanwhile.
// Waits for their end, for `patience` at most.
void kill_left(const std::string& mark, const std::string& variable, Duration patience);

}  // namespace culprit::owners
