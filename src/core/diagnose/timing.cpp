#include "diagnose/timing.h"

#include <algorithm>
#include <optional>

#include "language/evaluate.h"

namespace culprit::diagnose {
namespace {

using Kind = Input::Kind;

// The onset of a silence or a death that the input shows now; empty: it shows none.
std::optional<Onset> outage_of(const Input& input, Time now, const Knowledge& knowledge) {
  if (watches_a_topic(input)) {
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
    if (is_silent(input.topic, now, knowledge)) return onset_of_silence(rhythm);
    if (input.kind == Kind::kRate && rhythm.slowing) {
      // Some messages in time do not make it later than what it slows down.
      return Onset{std::min(rhythm.slowing->since, now - input.window),
                   later(rhythm.slowing->since, rhythm.slowing->gap)};
    }
    if (input.kind == Kind::kRate) return Onset{now - input.window, now};
    if (rhythm.last) return Onset{*rhythm.last, now};
    return std::nullopt;
  }
  const ComponentState& state = knowledge.components[input.component];
  if (input.kind == Kind::kAlive && state.hangs())
    return onset_of_hang(state, published_last(knowledge)[input.component.index]);
  if (input.kind == Kind::kAlive && state.alive == false)
    return Onset{state.alive_since, state.alive_since};
  if (input.kind == Kind::kLifecycle && state.lifecycle_since != kLongAgo)
    return Onset{state.lifecycle_since, state.lifecycle_since};
  return std::nullopt;
}

// HOLD n/k: at least n - 1 cycles pass from the onset until the rule fires, usually at most k.
Duration held_at_least(RuleId rule, const Knowledge& knowledge) {
  return duration_of(Cycles{knowledge.rules[rule].policies.hold_needed - 1}, knowledge.rules);
}
Duration held_at_most(RuleId rule, const Knowledge& knowledge) {
  const int window = knowledge.rules[rule].policies.hold_window;
  return duration_of(Cycles{window > 1 ? window : 0}, knowledge.rules);
}

// The onset of a bad value that made the trigger true `since` then.
Onset onset_of_value(RuleId rule, Time since, const Knowledge& knowledge) {
  const Latencies::Range lateness = knowledge.latencies.lateness(rule);
  return {since - reading_of(rule, knowledge) - knowledge.latencies.reckon_with(rule) -
              held_at_most(rule, knowledge),
          since - lateness.least - held_at_least(rule, knowledge)};
}

// Has its next message come late already?
bool comes_late(const SignalStore::Rhythm& rhythm, Time now) {
  return rhythm.last && rhythm.is_steady() &&
         now > later(rhythm.silent_since(), rhythm.gap + rhythm.gap / 8);
}

}  // namespace

bool is_over_window(const Input& input) {
  return input.kind == Kind::kMean || input.kind == Kind::kMin || input.kind == Kind::kMax ||
         input.kind == Kind::kStddev || input.kind == Kind::kFrozen;
}

bool watches_a_topic(const Input& input) {
  return input.kind == Kind::kAge || input.kind == Kind::kPhi || input.kind == Kind::kRate;
}

bool watches_a_component(const Input& input) {
  return input.kind == Kind::kAlive || input.kind == Kind::kLifecycle;
}

bool tells_of_data(RuleId rule, const RuleSet& rules) {
  const auto is_data = [&](InputId id) {
    const Input& input = rules[id];
    switch (input.subject()) {
      case Input::Subject::kComponent:
      case Input::Subject::kParameter:
        return false;
      case Input::Subject::kTopic:
      case Input::Subject::kDiagnostic:
        return true;
      case Input::Subject::kSignal:
        break;
    }
    const auto& source = rules[input.signal].source;
    return !std::holds_alternative<ParameterId>(source) && !std::holds_alternative<GroupId>(source);
  };
  return std::ranges::any_of(rules[rule].inputs, is_data);
}

// A latency is two of the intervals that a signal is read in, and its window.
Duration reading_of(RuleId rule, const Knowledge& knowledge) {
  Duration longest{};
  for (const InputId id : knowledge.rules[rule].inputs) {
    const Input& input = knowledge.rules[id];
    const Duration window = is_over_window(input) ? input.window : Duration::zero();
    longest = std::max<Duration>(longest, (knowledge.signals.latency(id) + window) / 2);
  }
  return longest;
}

Symptom symptom_of(RuleId rule, const Knowledge& knowledge) {
  const auto& inputs = knowledge.rules[rule].inputs;
  const bool reads_values = std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
    return !watches_a_topic(knowledge.rules[id]) && !watches_a_component(knowledge.rules[id]);
  });
  return reads_values ? Symptom::kValue : Symptom::kOutage;
}

std::vector<Time> published_last(const Knowledge& knowledge) {
  std::vector<Time> last(knowledge.rules.components.size(), kLongAgo);
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const auto& came = knowledge.signals.rhythm(TopicId(t)).last;
    if (!came) continue;
    if (const auto c = knowledge.graph.only_publisher(knowledge.rules.topics[t]))
      last[c->index] = std::max(last[c->index], *came);
  }
  return last;
}

// One that is busy may answer nothing for long, and publish. One that waits in a call may miss a probe.
Onset onset_of_hang(const ComponentState& state, Time published) {
  const Time found = state.alive == false ? state.alive_since : kNever;
  const Time missed = state.missed_probes > 1 ? std::max(state.missed_since, published) : kNever;
  return {state.answered, std::min({found, missed, state.questioned.unanswered.value_or(kNever)})};
}

Onset onset_of_silence(const SignalStore::Rhythm& rhythm) {
  Onset onset{*rhythm.last, later(rhythm.silent_since(), rhythm.gap)};
  if (rhythm.slowing) onset.earliest = std::min(onset.earliest, rhythm.slowing->since);
  return onset;
}

bool is_silent(TopicId topic, Time now, const Knowledge& knowledge) {
  const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(topic);
  return rhythm.last && rhythm.gap > Duration::zero() &&
         now > later(rhythm.silent_since(), kSilentGaps * rhythm.gap);
}

Onset onset_now(RuleId rule, Time now, const Knowledge& knowledge) {
  std::optional<Onset> outage;
  for (const InputId id : knowledge.rules[rule].inputs) {
    const Input& input = knowledge.rules[id];
    if (!watches_a_topic(input) && !watches_a_component(input)) continue;
    const auto found = outage_of(input, now, knowledge);
    if (!found) continue;
    if (!outage) outage = found;
    outage->earliest = std::min(outage->earliest, found->earliest);
    outage->latest = std::max(outage->latest, found->latest);
  }
  if (outage) return *outage;
  const Detection& detection = knowledge.states[rule].detection;
  const bool is_true = detection.trigger.known && detection.trigger.b;
  const bool has_lasted = is_true && detection.history.empty();  // FOR
  return onset_of_value(rule, has_lasted ? std::min(detection.trigger_since, now) : now, knowledge);
}

Onset onset_of(RuleId failure, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[failure];
  if (state.onset) return *state.onset;
  return onset_of_value(failure, state.failing_since, knowledge);
}

Time first_onset_of(RuleId failure, const Knowledge& knowledge) {
  return std::min(onset_of(failure, knowledge).latest, knowledge.states[failure].first_onset);
}

Duration presumed_lateness(RuleId failure, const Knowledge& knowledge) {
  const Latencies::Range lateness = knowledge.latencies.lateness(failure);
  return symptom_of(failure, knowledge) == Symptom::kValue ? lateness.presumed - lateness.least
                                                           : Duration::zero();
}

bool may_fire(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  const bool has_acted = knowledge.rules[rule].policies.on_change && !state.detection.armed;
  return state.phase == RulePhase::kQuiet && knowledge.now >= state.quiet_until && !has_acted;
}

Duration evidence_within(RuleId quiet, Time onset, const Knowledge& knowledge) {
  if (!may_fire(quiet, knowledge) || !knowledge.states[quiet].detection.trigger.known)
    return Duration::zero();
  Duration longest{};
  Duration most = kLongestEvidence;
  bool reads_value = false;
  for (const InputId id : knowledge.rules[quiet].inputs) {
    const Input& input = knowledge.rules[id];
    if (watches_a_topic(input)) {
      const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
      if (rhythm.last && *rhythm.last <= onset)
        longest = std::max<Duration>(longest, kSilentGaps * rhythm.gap);
      const bool shows_late = input.kind == Kind::kRate && rhythm.is_slow_since(onset);
      if (shows_late) {
        const Duration shown = input.window + knowledge.rules[quiet].policies.hold_for +
                               held_at_most(quiet, knowledge);
        longest = std::max<Duration>(longest, later(rhythm.slowing->since, shown) - onset);
      }
      if (shows_late || comes_late(rhythm, knowledge.now)) most = kLongestPlainEvidence;
    } else if (!watches_a_component(input)) {
      reads_value = knowledge.latencies.is_late(quiet);
    }
  }
  if (reads_value) {
    longest =
        std::max(longest, reading_of(quiet, knowledge) + knowledge.latencies.reckon_with(quiet) +
                              held_at_most(quiet, knowledge));
  }
  return std::min(longest, most);
}

bool may_yet_show(RuleId quiet, Time onset, const Knowledge& knowledge) {
  const Slot& trigger = knowledge.states[quiet].detection.trigger;
  const auto& inputs = knowledge.rules[quiet].inputs;
  const bool asks = std::ranges::any_of(
      inputs, [&](InputId id) { return watches_a_component(knowledge.rules[id]); });
  const Duration within = asks ? kLongestPlainEvidence : evidence_within(quiet, onset, knowledge);
  return trigger.known && (trigger.b || knowledge.now < later(onset, within));
}

Duration remembers(RuleId rule, const RuleSet& rules) {
  Duration longest{};
  for (const InputId id : rules[rule].inputs) longest = std::max(longest, rules[id].window);
  return longest;
}

namespace {

// Does the input count events of which each makes the rule's trigger more likely? Goals that succeed do not.
bool counts_bad_events(InputId id, RuleId rule, const Knowledge& knowledge) {
  const Kind kind = knowledge.rules[id].kind;
  if (kind != Kind::kLogs && kind != Kind::kGoals) return false;
  const Assumed none{id, Slot::of(std::int64_t{0})};
  const Slot trigger =
      evaluate(knowledge.rules[rule].trigger, knowledge.signals.slots(), {&none, 1});
  return !trigger.known || !trigger.b;
}

}  // namespace

bool is_bad_anew(RuleId rule, Time since, const Knowledge& knowledge) {
  return std::ranges::any_of(knowledge.rules[rule].inputs, [&](InputId id) {
    const Input& input = knowledge.rules[id];
    if (counts_bad_events(id, rule, knowledge)) return knowledge.signals.arrivals(id).last > since;
    if (!watches_a_topic(input)) return false;
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
    if (!rhythm.last || rhythm.gap == Duration::zero()) return false;
    if (rhythm.slowing)
      return *rhythm.last > later(std::max(since, rhythm.slowing->since), 2 * rhythm.slowing->gap);
    return knowledge.now > later(std::max(rhythm.silent_since(), since), kSilentGaps * rhythm.gap);
  });
}

Duration clears_within(RuleId failure, const Knowledge& knowledge) {
  return knowledge.signals.latency(failure) + knowledge.latencies.reckon_with(failure) +
         held_at_most(failure, knowledge);
}

Time settles_by(RuleId failure, Time since, Time until, const Knowledge& knowledge) {
  const Time usual = later(since, kLongestEvidence);
  const Time passed = later(since, duration_of(kPassing, knowledge.rules));
  return until > usual && is_bad_anew(failure, passed, knowledge) ? usual : until;
}

}  // namespace culprit::diagnose
