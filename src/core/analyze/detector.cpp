#include "analyze/detector.h"

#include <algorithm>

#include "language/evaluate.h"

namespace culprit {

Duration longest_detection(const RuleSet& rules) {
  Duration longest{};
  for (const Rule& rule : rules.rules)
    longest = std::max(
        {longest, rule.policies.hold_for, rules.cycle * std::int64_t{rule.policies.hold_window}});
  return longest;
}

void Detector::evaluate(RuleId id, Time now) {
  Detection& detection = states_.state(id).detection;
  const Slot is = value(id, now);
  if (is_false(is)) {
    const Time worked = seen_working_.until(id, now);
    detection.works = worked == now;
    detection.last_false = std::max(detection.last_false, worked);
  } else if (detection.works) {  // until now, whatever its inputs show now
    detection.works = false;
    detection.last_false = now;
  }
  if (!same(is, detection.trigger, Type::kBool) || detection.trigger_since == kLongAgo) {
    detection.trigger = is;
    detection.trigger_since = now;
  }
  if (!is_true(is)) detection.armed = true;
  if (!detection.history.empty()) sample_history(detection, now);
}

Slot Detector::value(RuleId id, Time now) {
  Detection& detection = states_.state(id).detection;
  const Slot value = culprit::evaluate(knowledge_.rules[id].trigger, knowledge_.signals.slots());
  const auto dead = known_silence_.behind(id);
  if (!dead) {
    detection.known_death.reset();
    return value;
  }
  if (!detection.known_death || detection.known_death->component != *dead)
    detection.known_death = {*dead, now};
  return Slot::of(true);
}

void Detector::sample_history(Detection& detection, Time now) const {
  if (detection.sampled != kLongAgo && now < later(detection.sampled, knowledge_.rules.cycle))
    return;
  detection.sampled = now;
  detection.newest = (detection.newest + 1) % detection.history.size();
  detection.true_in_history -= detection.history[detection.newest] ? 1 : 0;
  detection.history[detection.newest] = is_true(detection.trigger);
  detection.true_in_history += detection.history[detection.newest] ? 1 : 0;
}

void Detector::restart(RuleId id, Time now) {
  Detection& detection = states_.state(id).detection;
  if (detection.trigger_since != kLongAgo) detection.trigger_since = now;
  detection.works = false;
  detection.history.assign(detection.history.size(), false);
  detection.true_in_history = 0;
}

bool Detector::detects(RuleId id, Time now) const {
  const RuleState& state = knowledge_.states[id];
  const Policies& policies = knowledge_.rules[id].policies;
  if (now < state.quiet_until || (policies.on_change && !state.detection.armed)) return false;
  if (!state.detection.history.empty())
    return state.detection.true_in_history >= policies.hold_needed;
  return is_true(state.detection.trigger) &&
         now >= later(state.detection.trigger_since, policies.hold_for);
}

Duration Detector::clearing_time(RuleId id) const {
  const Policies& policies = knowledge_.rules[id].policies;
  const int held = policies.hold_window > 1 ? policies.hold_window - policies.hold_needed + 1 : 1;
  return std::max(policies.hold_for, knowledge_.rules.cycle * held);
}

bool Detector::is_cleared(RuleId id, Time now) const {
  const Detection& detection = knowledge_.states[id].detection;
  return is_false(detection.trigger) && now >= later(detection.trigger_since, clearing_time(id));
}

Time Detector::next(RuleId id, Time now) const {
  const RuleState& state = knowledge_.states[id];
  const Detection& detection = state.detection;
  Time next = kNever;
  const auto want = [&](Time at) {
    if (at > now) next = std::min(next, at);
  };
  if (is_false(detection.trigger) && state.phase != RulePhase::kQuiet)
    want(later(detection.trigger_since, clearing_time(id)));
  if (is_true(detection.trigger) && state.phase == RulePhase::kQuiet) {
    want(later(detection.trigger_since, knowledge_.rules[id].policies.hold_for));
    want(state.quiet_until);
  }
  const auto window = static_cast<int>(detection.history.size());
  if (window > 0 && detection.true_in_history != (is_true(detection.trigger) ? window : 0))
    want(later(detection.sampled, knowledge_.rules.cycle));
  return next;
}

}  // namespace culprit
