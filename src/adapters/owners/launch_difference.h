// How a running process differs from the one that its LAUNCH would start.
//
// The comparison covers the program, the arguments in order, and the parameters that both read from files.
// It resolves `ros2 run` and `python3`: `ros2 run cam driver` is the program `driver`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "owners/start_of.h"

namespace culprit::owners {

// A process as the operating system shows it.
struct RunningProcess {
  Started started;
  std::string program;           // that it runs, by its whole path
  bool program_is_gone = false;  // it was replaced, or removed
  std::int64_t started_at = 0;   // seconds since 1970
};

// Nothing: there is no such process, or it may not be looked into.
std::optional<RunningProcess> running_process(int pid);

// Sentences without a subject, as "runs with '--fps 30', and its LAUNCH has '--fps 15'". Empty: it would run
// as it does. `folder`: where the LAUNCH runs; empty: here. `node`: the full name of the node.
std::vector<std::string> launch_differences(const std::vector<std::string>& launch,
                                            const std::string& folder, const std::string& node,
                                            const RunningProcess& process);

}  // namespace culprit::owners
