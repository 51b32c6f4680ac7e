// The processes that culprit started and that run on: found by their marks, whether or not a culprit runs.
#pragma once

#include <string>
#include <vector>

#include "base/time.h"

namespace culprit::owners {

struct StartedProcess {
  std::string robot;  // "0/sunset"
  std::string component;
  int pid = 0;
  int launcher = 0;  // of the launch that it stands in for; 0: of none
  Time since{};
};

// Those of the robot `robot` ("0/sunset"), or, where `robot` ends with a slash ("0/"), of all robots of that domain.
// Only of this user. A process that a marked one started in turn is not among them.
std::vector<StartedProcess> started_processes(const std::string& robot);

// "camera (process 4711, for 3 min, in place of one of process 4000)"
std::string to_string(const StartedProcess& process, Time now);

// Ends them as ros2 launch does, with all in their groups: SIGINT, after Supervisor::kOfLaunch SIGTERM, after
// Supervisor::kOfLaunch SIGKILL. Waits for that. Gives those that are still there. A process that is not the one that
// was found (PIDs are reused) is left alone.
std::vector<StartedProcess> end_processes(const std::vector<StartedProcess>& processes);

// The other processes that run and that the launcher of this process started. Empty: there are none, or no launcher is known.
std::vector<int> others_of_own_launch();

// For a culprit that ends: if all of `others`, which ran when it was ordered to end, end within
// `patience`, its own launch is being ended. Then asks the processes that stand in for others of
// that launch to end (SIGINT), and gives them.
std::vector<StartedProcess> end_with_own_launch(const std::string& robot,
                                                const std::vector<int>& others, Duration patience);

}  // namespace culprit::owners
