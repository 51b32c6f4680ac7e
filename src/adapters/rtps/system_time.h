// Times by a wall clock: the writer's that sent something, or ours when it came.
#pragma once

#include <chrono>

namespace culprit::rtps {

using SystemTime = std::chrono::sys_time<std::chrono::nanoseconds>;

}  // namespace culprit::rtps
