// Is a failure about to be detected? A rule that has not fired yet is suspicious if what it watches
// already looks ill.
//
// Often the failure downstream is seen first, because its detector is faster or its last sample
// came earlier. Acting on it at once would repair what is not broken.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::plan {

// A topic is suspicious when its gap is this many times as long as usual.
inline constexpr int kSuspiciousGaps = 2;
// A failure waits for suspicious others no longer than so many cycles after its detection, or so
// many times the latency of the signals of suspicious rules if that is longer.
inline constexpr Cycles kLongestWait{5};
inline constexpr int kLongestWaitLatencies = 3;

// A strategy that helps at least so likely, and takes nothing down, need not wait for what looks
// ill downstream of it: whether it helped may not be seen, but hardly matters.
inline constexpr double kSure = 0.9;

// The rule is quiet, and one of these holds:
//   - its trigger is true, and its policy's time (FOR) is not over; or it was true in half as many
//     evaluations as its HOLD needs;
//   - a topic whose age, phi or rate its trigger reads is silent for longer than it usually is;
//   - a signal that its trigger reads was never so near to firing it lately (SignalStore);
//   - a component of it is known to be gone or stopped.
bool is_suspicious(RuleId rule, const Knowledge& knowledge);

// What a rule sees of a failure. The former has early signs (a topic that sends nothing), the
// latter has none.
enum class Symptom : std::uint8_t {
  kOutage,  // its trigger reads topics' ages, rates, or who is alive
  kValue    // it reads the value of a signal, a parameter or a diagnostic
};
Symptom symptom_of(RuleId rule, const Knowledge& knowledge);

// How long a topic of the dead must be silent until the rule's trigger tells: as long as the
// trigger says, or, while nobody can judge the gap yet, and otherwise at most,
// kLongestSilence. Zero if it reads no topic's silence.
Duration silence_to_tell(RuleId rule, const Knowledge& knowledge);
inline constexpr Duration kLongestSilence = std::chrono::seconds(10);

// All that are, ascending.
std::vector<RuleId> suspicious_rules(const Knowledge& knowledge);

// A bad value that was detected less than kLongestWait ago: what it is the effect of may only not
// have been detected yet.
bool is_young(RuleId failure, const Knowledge& knowledge);
// The same within the time that its own signals take to show a change: those upstream may need as
// long.
bool is_newborn(RuleId failure, const Knowledge& knowledge);
// Until when it is.
Time newborn_until(RuleId failure, const Knowledge& knowledge);

// Can the rule have something new to tell by then? What is read in a rhythm has only with its next
// reading: who waits for less, waits in vain.
bool is_heard_by(Time until, RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::plan
