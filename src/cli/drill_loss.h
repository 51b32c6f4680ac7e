// Loses datagrams of one process on this computer, with nftables, so as root or with CAP_NET_ADMIN.
//
// The kernel removes the table as soon as the nft program that made it ends. The nft program reads from us, so it ends with
// the drill, however the drill ends, and after a time in any case. So no rule of the firewall outlives a drill.
#pragma once

#include <set>

#include "base/expected.h"
#include "base/units.h"
#include "owners/file_descriptor.h"

namespace culprit::cli {

// A process that ends a fault.
struct FaultGuard {
  int pid = 0;                   // to be waited for
  owners::FileDescriptor alive;  // the fault and the guard end when it is closed
};

// The UDP ports that only this process has. A port of discovery is shared by all nodes and is not among them.
std::set<int> own_ports_of(int pid);

// Errors: nft is missing or not permitted, or the process has no port of its own, or lives in another network namespace.
Expected<void> may_lose_datagrams(int pid);

// Four of five datagrams from and to its ports are lost, for `at_most` if `alive` is not closed before. Errors: as above.
Expected<FaultGuard> lose_datagrams(int pid, Duration at_most);

}  // namespace culprit::cli
