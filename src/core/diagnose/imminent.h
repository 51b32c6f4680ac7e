// Rules that have not fired yet although what they read already looks bad.
//
// Often the failure downstream is detected first, because its detector is faster or its last sample
// came earlier. Acting on it at once would repair a component that is well.
#pragma once

#include <optional>
#include <vector>

#include "diagnose/timing.h"
#include "language/program.h"

namespace culprit::diagnose {

// The value that the input takes if its topic stays silent; empty: silence does not decide it. A
// rate ends at 0; an age or a suspicion beyond all constants, if it is compared with nothing else.
std::optional<Slot> after_long_silence(const Input& input);

// The rule is quiet, and one of these holds:
//   - its trigger is true, and its policy's time (FOR) is not over; or it was true in half as many
//     evaluations as its HOLD needs;
//   - topics that its trigger reads are silent for longer than usual, and it will fire if that lasts;
//   - the last reading of a signal that its trigger reads was nearer to firing it than any lately
//     (SignalStore::is_unusual).
bool is_imminent(RuleId rule, const Knowledge& knowledge);
// Is it so, and fires only once its COOLDOWN is over, within kLongestCooldown? A cooldown hides the alarm, and not the
// evidence.
inline constexpr Duration kLongestCooldown = std::chrono::seconds(60);
bool is_held_by_cooldown(RuleId rule, const Knowledge& knowledge);

// All that are, ascending.
std::vector<RuleId> imminent_rules(const Knowledge& knowledge);

}  // namespace culprit::diagnose
