// The processes of a live robot on this machine, as the kernel knows them.
//
// Not as the DDS graph knows them: there, a process that was just started is not known for a
// moment, and one that was killed is known for 20 s.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace culprit {

// The pids of the processes of `program` ("sunset-node") that were started with the argument `name`
// and for this DDS domain; usually one. Processes of other users are left out, since the kernel
// hides their arguments.
std::vector<int> processes_of(std::string_view program, std::string_view name,
                              std::uint32_t domain);

}  // namespace culprit
