// When a failure began, and from when on a quiet rule counts as health.
//
// Rules are alarms, and alarms come late. Symbols, for a rule r:
//
//   [e_r, l_r]   onset: the failure that r sees began between e_r and l_r
//   E_r          after an onset, r (or what it reads) shows it within E_r
//
//   trigger reads            e_r                              l_r                    E_r
//   age, phi, rate, silent   last sample                      silent since + gap     2 gaps
//   rate, slow               last sample in time              a usual gap later      until the topic is slow for
//                                                                                    the window, FOR and HOLD
//   rate, else               detection - window               detection              2 gaps
//   alive                    when that changed                the same               none: asked
//   alive, it hangs          last answer                      second one missed      none: asked
//   lifecycle                when the state was read          the same               none: asked
//   a value                  t - reading - most lateness      t - least lateness     reading + most lateness
//
// where t is the time from which the trigger has been true (HOLD n/k: the detection; k cycles more for
// e_r and E_r, n - 1 cycles less for l_r), `gap` the usual pause of the topic, `reading` the period of
// the signal and the window that the trigger looks at; `silent since` is the last sample, or the time
// when culprit received again after a gap; and the lateness is that of knowledge/latencies.h. If a
// trigger reads several inputs, silent topics and dead components decide before values.
//
// Rule u can be the cause of failure i only if it began before it: e_u <= l_i. While
//
//     now < l_i + E_u
//
// a quiet rule u can still fire as the cause of i: it says nothing about i. From then on, or once its
// topics have sent after l_i, it says that its components are well.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// The kind of symptom that a rule detects.
enum class Symptom : std::uint8_t {
  kOutage,  // its trigger reads topics' ages, rates, or what is alive
  kValue    // it reads the value of a signal, a parameter or a diagnostic
};
Symptom symptom_of(RuleId rule, const Knowledge& knowledge);

bool watches_a_topic(const Input& input);
bool watches_a_component(const Input& input);
// Does the rule tell whether data flows, or whether it is good? One that reads only whether its
// component is there and active, its load, its log or its parameters does not.
bool tells_of_data(RuleId rule, const RuleSet& rules);

// A topic counts as silent after this many of its usual gaps.
inline constexpr int kSilentGaps = SignalStore::Rhythm::kSilentGaps;
// Evidence that takes longer than this is not waited for; while a topic is late or slow already, evidence about it that
// takes longer than the other.
inline constexpr Duration kLongestEvidence = std::chrono::seconds(10);
inline constexpr Duration kLongestPlainEvidence = std::chrono::seconds(30);
// How long a bad value usually takes along the graph.
inline constexpr Cycles kPassing{5};

// Is the topic silent at `now` for longer than it usually is? Not while its rhythm is unknown.
bool is_silent(TopicId topic, Time now, const Knowledge& knowledge);
// The onset of the silence of one that is silent, which may have become slow before.
Onset onset_of_silence(const SignalStore::Rhythm& rhythm);

// By component: when the last message came on a topic that it alone publishes; kLongAgo: none did.
std::vector<Time> published_last(const Knowledge& knowledge);
// For a component that hangs, or did not answer a probe: its failure may have begun right after its
// last answer, and had begun when a second probe in a row got none and its last message had come:
// `published`, as published_last() says. A single one may be lost, or come while the component waits for a
// supplier that answers still; and mostly more than two have to show that it hangs.
Onset onset_of_hang(const ComponentState& state, Time published);
// Does the input show a change of its signal only once that lasted for its window?
bool is_over_window(const Input& input);
// How long after a change the rule reads it at the latest, besides its lateness: the period of its
// signal, and the window that it looks at.
Duration reading_of(RuleId rule, const Knowledge& knowledge);

// The onset of what the rule sees, if its failure is detected at `now`.
Onset onset_now(RuleId rule, Time now, const Knowledge& knowledge);
// The onset of a detected failure, as it is there now; and the latest onset of the first of its
// detections, if it comes and goes.
Onset onset_of(RuleId failure, const Knowledge& knowledge);
Time first_onset_of(RuleId failure, const Knowledge& knowledge);
// How much earlier than the latest possible onset the failure presumably began.
Duration presumed_lateness(RuleId failure, const Knowledge& knowledge);

// Can the rule fire: it is quiet, its COOLDOWN is over, and with ON_CHANGE its trigger was not true since it
// acted?
bool may_fire(RuleId rule, const Knowledge& knowledge);
// E of a quiet rule; zero if it gives no evidence any more: its topics have sent since `onset` as they
// usually do, its trigger is unknown, it cannot fire, or its nodes must be asked.
Duration evidence_within(RuleId quiet, Time onset, const Knowledge& knowledge);

// May the quiet rule still fire for what began at `onset`: its trigger is true, its evidence can still come, or it asks
// whether its component is there, which can take long to know?
bool may_yet_show(RuleId quiet, Time onset, const Knowledge& knowledge);

// How long the failure may still be shown after its cause has cleared: the readings, the lateness
// and the HOLD of its rule.
Duration clears_within(RuleId failure, const Knowledge& knowledge);
// The longest window that the rule looks back on: so long it remembers what was before its cause cleared.
Duration remembers(RuleId rule, const RuleSet& rules);
// Does what the rule watches show that it is bad after `since`, too: a message is missing or late, or an event came?
bool is_bad_anew(RuleId rule, Time since, const Knowledge& knowledge);
// When a failure that may clear with a cause, which is over `since` then, has had its time: `until`, or earlier if it
// is bad anew.
Time settles_by(RuleId failure, Time since, Time until, const Knowledge& knowledge);

}  // namespace culprit::diagnose
