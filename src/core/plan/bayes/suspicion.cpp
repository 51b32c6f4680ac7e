#include "plan/bayes/suspicion.h"

#include <algorithm>

namespace culprit::plan {
namespace {

bool watches_a_topic(const Input& input) {
  return input.kind == Input::Kind::kAge || input.kind == Input::Kind::kPhi ||
         input.kind == Input::Kind::kRate;
}

bool is_unusual(InputId id, const Knowledge& knowledge) {
  return knowledge.rules[id].kind == Input::Kind::kSignal && knowledge.signals.is_unusual(id);
}

bool is_silent(const Input& input, const Knowledge& knowledge) {
  if (!watches_a_topic(input)) return false;
  const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
  return rhythm.last && rhythm.gap > Duration::zero() &&
         knowledge.now > later(*rhythm.last, kSuspiciousGaps * rhythm.gap);
}

// With HOLD one reading proves little.
bool is_coming(const RuleState& state, const Policies& policies) {
  if (state.detection.history.empty())
    return state.detection.trigger.known && state.detection.trigger.b;
  return 2 * state.detection.true_in_history > policies.hold_needed;
}

// With HOLD a failure may be seen earlier or later by as many evaluations as may be missed.
Time end_of(RuleId failure, Duration time, const Knowledge& knowledge) {
  const Policies& policies = knowledge.rules[failure].policies;
  const Cycles missed{policies.hold_window - policies.hold_needed};
  return later(knowledge.states[failure].first_detected(),
               time + duration_of(missed, knowledge.rules));
}

bool is_value_before(Time end, RuleId failure, const Knowledge& knowledge) {
  return symptom_of(failure, knowledge) == Symptom::kValue && knowledge.now < end;
}

}  // namespace

bool is_suspicious(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  if (state.phase != RulePhase::kQuiet || knowledge.now < state.quiet_until) return false;
  const Rule& watched = knowledge.rules[rule];
  if (is_coming(state, watched.policies)) return true;
  const auto is_down = [&](ComponentId c) { return knowledge.components[c].alive == false; };
  return std::any_of(watched.inputs.begin(), watched.inputs.end(),
                     [&](InputId id) {
                       return is_silent(knowledge.rules[id], knowledge) ||
                              is_unusual(id, knowledge);
                     }) ||
         std::any_of(watched.components.begin(), watched.components.end(), is_down);
}

std::vector<RuleId> suspicious_rules(const Knowledge& knowledge) {
  std::vector<RuleId> all;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    if (is_suspicious(RuleId(r), knowledge)) all.emplace_back(r);
  }
  return all;
}

Symptom symptom_of(RuleId rule, const Knowledge& knowledge) {
  const auto& inputs = knowledge.rules[rule].inputs;
  const bool reads_values = std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
    const Input& input = knowledge.rules[id];
    return !watches_a_topic(input) && input.kind != Input::Kind::kAlive &&
           input.kind != Input::Kind::kLifecycle;
  });
  return reads_values ? Symptom::kValue : Symptom::kOutage;
}

Duration silence_to_tell(RuleId rule, const Knowledge& knowledge) {
  Duration longest{};
  for (const InputId id : knowledge.rules[rule].inputs) {
    const Input& input = knowledge.rules[id];
    if (!watches_a_topic(input)) continue;
    if (input.kind == Input::Kind::kRate) longest = std::max(longest, input.window);
    if (input.kind == Input::Kind::kAge && !input.thresholds.empty())
      longest = std::max(longest, from_seconds(input.thresholds.back()));
    if (!knowledge.signals[id].known) longest = kLongestSilence;
  }
  return std::min(longest, kLongestSilence);
}

bool is_young(RuleId failure, const Knowledge& knowledge) {
  const Duration time = duration_of(kLongestWait, knowledge.rules);
  return is_value_before(end_of(failure, time, knowledge), failure, knowledge);
}

bool is_newborn(RuleId failure, const Knowledge& knowledge) {
  return is_value_before(newborn_until(failure, knowledge), failure, knowledge);
}

Time newborn_until(RuleId failure, const Knowledge& knowledge) {
  const Duration time = std::min<Duration>(duration_of(kLongestWait, knowledge.rules),
                                           knowledge.signals.latency(failure));
  return end_of(failure, time, knowledge);
}

bool is_heard_by(Time until, RuleId rule, const Knowledge& knowledge) {
  const SignalStore& signals = knowledge.signals;
  const auto& inputs = knowledge.rules[rule].inputs;
  return std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
    const Time read = signals.read_at(id);
    // A latency is two of the intervals that a signal is read in.
    return read == kLongAgo || later(read, signals.latency(id) / 2) <= until;
  });
}

}  // namespace culprit::plan
