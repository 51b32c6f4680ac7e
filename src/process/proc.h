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

// Processes with `variable` ("NAME=value") in the environment that they were started with, which
// others may not read: only those of one's own user, unless one may read all.
std::vector<int> processes_with(const std::string& variable);

}  // namespace culprit::process
