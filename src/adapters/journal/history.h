// The events of earlier runs on this robot, as the next run remembers them (knowledge/history.h):
// gathered from rows, and carried on from session to session until they no longer count.
#pragma once

#include "journal/json.h"
#include "knowledge/history.h"

namespace culprit::journal {

// Events count no longer than this. Exceptions: mutes, attempts on failures that have not cleared,
// and of each component its last process and its intended lifecycle state.
inline constexpr Duration kPastCounts = std::chrono::hours(1);

// Does the next run need it (knowledge/history.h)?
bool is_remembered(const Event& event);

// Leaves out what does not count at `now` any more.
History still_counting(const History& past, Time now, const RuleSet& rules);

// Keeps only what also holds on another robot, and on this one after a reboot, when its clock
// restarts: silences. `shift` is added to their times.
History of_people(const History& past, Duration shift);

Json to_json(const History& past, const RuleSet& rules);
// Leaves out what `rules` does not have.
History history_from_json(const Json& json, const RuleSet& rules);

}  // namespace culprit::journal
