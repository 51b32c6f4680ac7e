// Whether each component is there, as far as culprit knows without the rules about it.
//
// No alarm is not health: while a component is not known to run, no report says that all is well.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

// The worst first.
enum class Presence : std::uint8_t {
  kUnreachable,  // so is its host
  kDown,         // its process exited, or its node left the graph
  kHung,
  kStopped,     // by SIGSTOP
  kNeverSeen,   // and it had its time to show itself
  kNotSeenYet,  // discovery goes on
  kUnknown,     // it was seen once, and nothing says whether it is still there
  kStarting,    // its process runs, and its node is not there yet
  kThere
};

Presence presence_of(ComponentId id, const Knowledge& knowledge);

// "unreachable", "down", "never seen" ...; empty: it is there.
std::string_view to_string(Presence presence);

// Components that are not there, and all in the same way.
struct Absence {
  Presence how{};
  std::vector<ComponentId> who;  // ascending, not empty
};
// In the worst way that any is. One that starts is on its way, and no absence. Empty: all are there.
std::optional<Absence> worst_absence(const Knowledge& knowledge);

// "lidar was never seen", "lidar and camera are down", "12 components are down"
std::string describe(const Absence& absence, const RuleSet& rules);

}  // namespace culprit
