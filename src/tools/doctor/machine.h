// The properties of this machine that matter to all processes of a robot: its disks, and the
// domains that its processes are on.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "doctor/picture.h"

namespace culprit::doctor {

// The disks that the processes (by node) work on: those of their folders, and of their logs.
std::vector<Disk> disks_of(const std::map<std::string, int>& nodes);

// Domains, but for `own`, on which a socket of this machine waits for announcements (RTPS 2.3 §9.6.1.1),
// with the programs that may be seen. `nodes`: those of our domain.
std::vector<OtherDomain> other_domains(std::uint32_t own, const std::map<std::string, int>& nodes);

// "domain 42 (lidar_driver (process 4711)) and 2 more"
std::string domains_with_programs(const std::vector<OtherDomain>& others);

}  // namespace culprit::doctor
