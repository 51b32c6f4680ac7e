// Times by a wall clock: the writer's that sent something, or ours when it came.
#pragma once

#include <chrono>

namespace culprit::ros2 {

using SystemTime = std::chrono::sys_time<std::chrono::nanoseconds>;

}  // namespace culprit::ros2
