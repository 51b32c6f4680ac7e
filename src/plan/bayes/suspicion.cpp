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
  return rhythm.last && rhythm.interval > Duration::zero() &&
         knowledge.now > later(*rhythm.last, kSuspiciousIntervals * rhythm.interval);
}

}  // namespace

bool is_suspicious(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  if (state.phase != RulePhase::kQuiet || knowledge.now < state.quiet_until) return false;
  if (state.trigger.known && state.trigger.b) return true;
  const Rule& watched = knowledge.rules[rule];
  const auto is_down = [&](ComponentId c) { return knowledge.components[c].alive == false; };
  return std::any_of(watched.inputs.begin(), watched.inputs.end(),
                     [&](InputId id) {
                       return is_silent(knowledge.rules[id], knowledge) ||
                              is_unusual(id, knowledge);
                     }) ||
         std::any_of(watched.components.begin(), watched.components.end(), is_down);
}

}  // namespace culprit::plan
