// How a group is: what one lifecycle manager's components are together (GROUP).
//
// A member is up if it is alive and active. Right after a member came, went or changed its state, more will
// follow: the manager takes one after the other. So the group is *changing* until no member has changed for
// kGroupSettles, which is longer than a Nav2 manager needs to notice a broken bond (4 s).
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

#include "base/time.h"
#include "knowledge/component_states.h"
#include "language/rule_set.h"

namespace culprit {

inline constexpr Duration kGroupSettles = std::chrono::seconds(5);

enum class GroupHealth : std::uint8_t {
  kUnknown,   // of some member it is not known whether it is alive, or in which state
  kActive,    // all members are active
  kChanging,  // a member is in a transition, or changed a moment ago
  kInactive,  // all are inactive, as a pause leaves them; or were, and none was active since
  kDown,      // each is unconfigured, finalized or not alive
  kHalfUp     // none of these
};

// "active", "changing", "inactive", "down", "half_up"; empty: kUnknown.
std::string_view to_string(GroupHealth health);

GroupHealth health_of(const Group& group, const ComponentStates& components, Time now);

// When it may be another without any news; kNever: only news can change it.
Time settles_at(const Group& group, const ComponentStates& components, Time now);

}  // namespace culprit
