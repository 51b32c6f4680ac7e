// What the kernel tells of processes in /proc.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/time.h"

namespace culprit::process {

// 'R', 'S', 'T' (stopped), 'Z' (ended, not reaped) ...; nothing if there is no such process.
std::optional<char> state_letter(int pid);

// On live_now()'s clock, to a hundredth of a second.
std::optional<Time> started_at(int pid);

// Whether `variable` ("NAME=value") is in the environment that the process was started with, which
// others may not read: false for processes of another user, unless one may read all.
bool has_variable(int pid, const std::string& variable);
// All such processes.
std::vector<int> processes_with(const std::string& variable);

}  // namespace culprit::process
