// The processes of the live robot on this machine, as the kernel knows them.
//
// Not as the DDS graph knows them: there, a process that was just started is not known for a
// moment, and one that was killed is known for 20 s.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "exemplars/sunset/members.h"

namespace culprit::sunset {

// The pids of those sunset-nodes that were started as `member` and for this DDS domain; usually
// one. Processes of other users are left out, since the kernel hides their arguments.
std::vector<int> processes_of(Member member, std::uint32_t domain);

}  // namespace culprit::sunset
