// The processes of the live SUNSET on this machine (exemplars/node_process.h).
#pragma once

#include "exemplars/node_process.h"
#include "exemplars/sunset/members.h"

namespace culprit::sunset {

inline std::vector<int> processes_of(Member member, std::uint32_t domain) {
  return culprit::processes_of("sunset-node", name_of(member), domain);
}

}  // namespace culprit::sunset
