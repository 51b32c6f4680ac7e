// Processes that the operating system knows to be gone or stopped, or that hang, and the strategies that
// replace them.
//
// Such a process does not come back by itself, whatever else is repaired, and nothing of it is left
// that a replacement could disturb. So its component has a cause of its own, and its replacement
// waits for no other failure. A component that ended with its container has none: the
// container's replacement brings it back. A process that hangs has a cause of its own, too, unless it may
// wait for the answer of another one that is down: no missing message and no bad value makes it hang. If
// no rule repairs that one, the wait has an end.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// Is the process of `component` gone or stopped, and no container's replacement awaited?
bool is_known_down(ComponentId component, const Knowledge& knowledge);

// Does the strategy start a process of `component`?
bool replaces(const Strategy& strategy, ComponentId component);
// Does it replace a process that is known to be down?
bool revives(const Strategy& strategy, const Knowledge& knowledge);
// Does a strategy of the rule do so?
bool is_known_down(RuleId rule, const Knowledge& knowledge);
// Does a strategy of the rule begin a component anew that hangs?
bool is_about_hang(RuleId rule, const Knowledge& knowledge);
// Does it read the lifecycle of a component that it repairs and that is not active, or the health of a group with such a
// member?
bool reads_inactive(RuleId rule, const Knowledge& knowledge);

// A process may wait so long for an answer of a supplier that no rule repairs. By then a launcher or a
// person has brought the supplier back, or nobody will.
inline constexpr Duration kLongestWaitForAnswer = std::chrono::seconds(60);
// Until when the process that `failure` is about may hang only because `supplier` answers nothing, which
// does so since `since`. kNever: as long as the supplier is down, because a rule repairs it, or because a
// strategy of `failure` was tried in vain.
Time may_wait_for_answer_until(RuleId failure, ComponentId supplier, Time since,
                               const Knowledge& knowledge);

}  // namespace culprit::diagnose
