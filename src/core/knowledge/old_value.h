// Values that were kept from a publisher that sends no more.
//
// A value without a STALE may be old for ever. It no longer counts if its topic has no publisher any
// more, its component is lost, or its diagnostic has paused for ten times its usual pause
// (kLeastPause at least). Other topics may publish on demand, so their pauses prove nothing.
#pragma once

#include <chrono>
#include <vector>

#include "knowledge/knowledge.h"
#include "language/evaluate.h"

namespace culprit {

inline constexpr Duration kLeastPause = std::chrono::seconds(10);
// A topic may be without a publisher for a moment.
inline constexpr Duration kPublisherIsBack = std::chrono::seconds(5);

// Does the input keep its last value? The monitor forgets a signal at its STALE, and a window empties by itself.
bool keeps_last_value(const Input& input, const RuleSet& rules);

// When the last value can be old at the earliest; kNever: only another value says so. No pause counts
// from before `heard_from`.
// @pre keeps_last_value()
Time fresh_until(InputId input, Time heard_from, const Knowledge& knowledge);

// Is the value that is known now old?
// @pre keeps_last_value()
bool is_old(InputId input, Time heard_from, const Knowledge& knowledge);

// The inputs of the condition whose values are old: unknown. They are never a reason to act.
std::vector<Assumed> without_old_values(const Program& condition, const Knowledge& knowledge);

// The condition as it is now.
Slot evaluate_now(const Program& condition, const Knowledge& knowledge);

// The WHEN of the strategy as it is now. A last resort never waits, so it counts on the last value.
// @pre it has one
Slot evaluate_when(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit
