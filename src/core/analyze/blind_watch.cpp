#include "analyze/blind_watch.h"

#include <algorithm>
#include <utility>

#include "knowledge/describe.h"
#include "knowledge/named.h"
#include "knowledge/old_value.h"
#include "language/evaluate.h"

namespace culprit {
namespace {

using Kind = Input::Kind;

// The part of the input that the robot never had.
Nameable never_seen_of(const Input& input, const Knowledge& knowledge) {
  const Discovered& discovered = knowledge.discovered;
  switch (input.subject()) {
    case Input::Subject::kTopic:
      return input.topic;
    case Input::Subject::kComponent:
      return input.component;
    case Input::Subject::kParameter: {
      const ComponentId component = knowledge.rules[input.parameter].component;
      if (!discovered.has(component)) return component;
      return input.parameter;
    }
    case Input::Subject::kDiagnostic:
      return input.diagnostic;
    case Input::Subject::kSignal:
      break;
  }
  const auto& source = knowledge.rules[input.signal].source;
  const auto* field = std::get_if<TopicField>(&source);
  if (field != nullptr && !discovered.has(field->topic)) return field->topic;
  const auto* parameter = std::get_if<ParameterId>(&source);
  if (parameter != nullptr && !discovered.has(knowledge.rules[*parameter].component))
    return knowledge.rules[*parameter].component;
  return input.signal;
}

std::string name_of(const Nameable& what, const RuleSet& rules) {
  if (const auto* diagnostic = std::get_if<DiagnosticId>(&what))
    return "diagnostic " + rules.diagnostics[diagnostic->index].name;
  if (const auto* parameter = std::get_if<ParameterId>(&what))
    return "parameter " + rules[*parameter].name + " of " + rules[rules[*parameter].component].name;
  if (const auto* signal = std::get_if<SignalId>(&what)) return "signal " + rules[*signal].name;
  if (const auto* topic = std::get_if<TopicId>(&what)) return rules.label(*topic);
  return rules[std::get<ComponentId>(what)].name;
}

// Empty if only the value is missing, as with a field that a topic's messages do not have.
std::string near_name_of(const Nameable& what, const Knowledge& knowledge) {
  const auto* signal = std::get_if<SignalId>(&what);
  const bool is_field =
      signal != nullptr && std::holds_alternative<TopicField>(knowledge.rules[*signal].source);
  return is_field ? "" : nearest_name(what, knowledge);
}

}  // namespace

BlindWatch::BlindWatch(const Knowledge& knowledge, Writes writes, Time start, Time discovered)
    : knowledge_(knowledge),
      write_(writes),
      judged_from_(discovered),
      heard_from_(start),
      sights_(knowledge.rules.rules.size()),
      may_be_old_(knowledge.rules.rules.size()),
      deadlines_(knowledge.rules.rules.size()) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t r = 0; r < sights_.size(); ++r) {
    sights_[r].lost = start;
    deadlines_.set(r, later(discovered, kDebounce));
    const auto& inputs = rules.rules[r].inputs;
    std::copy_if(inputs.begin(), inputs.end(), std::back_inserter(may_be_old_[r]),
                 [&](InputId id) { return keeps_last_value(rules[id], rules); });
  }
}

void BlindWatch::evaluated(RuleId rule, Time now) {
  const bool is_known = knowledge_.states[rule].detection.trigger.known;
  if (std::exchange(sights_[rule.index].was_known, is_known) != is_known)
    deadlines_.set(rule.index, now);
}

void BlindWatch::restart(Time now) {
  judged_from_ = std::max(judged_from_, now);
  heard_from_ = now;
  for (std::size_t r = 0; r < sights_.size(); ++r) {
    if (sights_[r].lost != kNever && !knowledge_.blindness[RuleId(r)]) sights_[r].lost = now;
    if (sights_[r].regained != kNever) sights_[r].regained = now;
    deadlines_.set(r, later(now, kDebounce));
  }
}

void BlindWatch::advance(Time now) {
  while (const auto due = deadlines_.pop_due(now)) look_at(RuleId(*due), now);
}

void BlindWatch::look_at(RuleId id, Time now) {
  if (can_see(id))
    look_at_seeing(id, now);
  else
    look_at_unseeing(id, now);
}

void BlindWatch::look_at_seeing(RuleId id, Time now) {
  Sight& sight = sights_[id.index];
  sight.lost = kNever;
  const auto& before = knowledge_.blindness[id];
  if (before && sight.regained == kNever) sight.regained = now;
  if (before && now < later(sight.regained, proof(sight)))
    return deadlines_.set(id.index, later(sight.regained, proof(sight)));
  if (before) {
    sight.regained = kNever;
    sight.proven_from = now;
    write_.events.tell(now, RuleSees{id, now - before->since});
    write_.blindness.clear(id);
  }
  deadlines_.set(id.index, next_look_at_old(id, now));
}

void BlindWatch::look_at_unseeing(RuleId id, Time now) {
  Sight& sight = sights_[id.index];
  sight.regained = kNever;
  if (sight.lost == kNever) sight.lost = now;
  if (knowledge_.components.is_any_time_held() && !knowledge_.blindness[id]) {
    sight.lost = now;
    return deadlines_.set(id.index, later(now, kDebounce));
  }
  // A new value that equals an old one touches no rule.
  if (knowledge_.blindness[id])
    return deadlines_.set(id.index, may_be_old_[id.index].empty() ? kNever : later(now, kDebounce));
  const Time due = later(std::max(sight.lost, judged_from_), debounce(id, now));
  const bool awaits_verdict = knowledge_.states[id].attempt.has_value();
  if (now < due || awaits_verdict)
    return deadlines_.set(id.index, std::max(due, later(now, std::chrono::seconds(1))));
  const bool is_anew = sight.proven_from == kLongAgo || later(sight.proven_from, kProven) <= now;
  sight.times = is_anew ? 1 : sight.times + 1;
  write_.blindness.set(id, blind(id, now));
  write_.events.tell(now, RuleBlind{id, *knowledge_.blindness[id]});
  deadlines_.set(id.index, may_be_old_[id.index].empty() ? kNever : later(now, kDebounce));
}

// How long a trigger must have a value again.
Duration BlindWatch::proof(const Sight& sight) const {
  const int doublings = std::clamp(sight.times - 1, 0, 10);
  return std::min<Duration>(kDebounce * (1 << doublings), kLongestProof);
}

bool BlindWatch::can_see(RuleId id) const {
  const Rule& rule = knowledge_.rules[id];
  const Detection& detection = knowledge_.states[id].detection;
  const bool was_evaluated = detection.trigger_since != kLongAgo;
  const Slot value =
      was_evaluated ? detection.trigger : evaluate(rule.trigger, knowledge_.signals.slots());
  if (!value.known || value.b) return value.known;
  std::vector<Assumed> without_old;
  for (const InputId input : may_be_old_[id.index]) {
    if (is_old(input, heard_from_, knowledge_)) without_old.push_back({input, Slot()});
  }
  return without_old.empty() ||
         evaluate(rule.trigger, knowledge_.signals.slots(), without_old).known;
}

Time BlindWatch::next_look_at_old(RuleId id, Time now) const {
  Time next = kNever;
  for (const InputId input : may_be_old_[id.index]) {
    // Until it is regular, or while its publisher is there.
    const Time until = fresh_until(input, heard_from_, knowledge_);
    next = std::min(next, until == kNever || until <= now ? later(now, kDebounce) : until);
  }
  return next;
}

std::optional<Unseen> BlindWatch::why_unseen(InputId id, Time now) const {
  if (!knowledge_.signals[id].known) return why_without_value(id, now);
  const bool may_be_old = keeps_last_value(knowledge_.rules[id], knowledge_.rules);
  return may_be_old && is_old(id, heard_from_, knowledge_) ? std::optional(Unseen::kStale)
                                                           : std::nullopt;
}

// @pre the input has no value
std::optional<Unseen> BlindWatch::why_without_value(InputId id, Time now) const {
  const Input& input = knowledge_.rules[id];
  const Discovered& discovered = knowledge_.discovered;
  const auto unless_seen = [](bool was_seen) {
    return was_seen ? Unseen::kUnknown : Unseen::kNeverSeen;
  };
  switch (input.kind) {
    case Kind::kRate:
    case Kind::kLoss:
      if (knowledge_.signals.rhythm(input.topic).last) return Unseen::kNotCovered;
      return unless_seen(discovered.has(input.topic));
    case Kind::kGoals:
      return discovered.has(input.topic) ? Unseen::kNotCovered : Unseen::kNeverSeen;
    case Kind::kLogs:
      return discovered.has(input.component) ? Unseen::kNotCovered : Unseen::kNeverSeen;
    case Kind::kAge:
    case Kind::kPhi:
    case Kind::kGoalAge:
      return unless_seen(discovered.has(input.topic));
    case Kind::kAlive:
    case Kind::kLifecycle:
    case Kind::kCpu:
    case Kind::kMemory:
      return unless_seen(discovered.has(input.component));
    case Kind::kParameter:
      return unless_seen(discovered.was_read(input.parameter));
    case Kind::kLevel:
      return unless_seen(discovered.was_read(input.diagnostic));
    case Kind::kSignal:
    case Kind::kMean:
    case Kind::kMin:
    case Kind::kMax:
    case Kind::kStddev:
    case Kind::kChanged:
    case Kind::kIsNan:
    case Kind::kFrozen:
      break;
  }
  if (!discovered.was_read(input.signal)) return Unseen::kNeverSeen;
  switch (*knowledge_.signals.why_unknown(id)) {
    case WhyUnknown::kStale:
      return Unseen::kStale;
    case WhyUnknown::kNotCovered: {
      const Time read = knowledge_.signals.read_at(id);
      return later(read, input.window) <= now ? Unseen::kStale : Unseen::kNotCovered;
    }
    case WhyUnknown::kNotANumber:
    case WhyUnknown::kUnreadable:
      return Unseen::kUnreadable;
    case WhyUnknown::kNoValue:
    case WhyUnknown::kOverflow:
      break;
  }
  return Unseen::kUnknown;
}

Duration BlindWatch::debounce(RuleId id, Time now) const {
  Duration longest = kDebounce;
  for (const InputId input : knowledge_.rules[id].inputs) {
    const auto why = why_unseen(input, now);
    if (!why || *why == Unseen::kNeverSeen) continue;
    const Input& read = knowledge_.rules[input];
    if (*why == Unseen::kNotCovered) longest = std::max(longest, read.window + kDebounce);
    longest = std::max(longest, read.subject() == Input::Subject::kTopic
                                    ? knowledge_.signals.rhythm(read.topic).gap
                                    : knowledge_.signals.arrivals(input).gap);
    const auto stale = read.subject() == Input::Subject::kSignal
                           ? knowledge_.rules[read.signal].stale
                           : std::nullopt;
    if (stale) longest = std::max(longest, *stale);
  }
  return longest;
}

// A name that the robot never had explains more than a value that is missing now.
Blind BlindWatch::blind(RuleId id, Time now) const {
  const RuleSet& rules = knowledge_.rules;
  Blind blind{.since = sights_[id.index].lost, .why = Unseen::kNoResult, .input = {}, .near = {}};
  for (const InputId input : rules[id].inputs) {
    const auto why = why_unseen(input, now);
    if (!why) continue;
    if (*why == Unseen::kNeverSeen) {
      const Nameable what = never_seen_of(rules[input], knowledge_);
      const std::string near = near_name_of(what, knowledge_);
      const bool is_better =
          blind.why != Unseen::kNeverSeen || (blind.near.empty() && !near.empty());
      if (is_better) blind = {blind.since, *why, name_of(what, rules), near};
    } else if (blind.why == Unseen::kNoResult) {
      blind.why = *why;
      blind.input = describe(rules[input], rules);
      const Time last = knowledge_.signals.arrivals(input).last;
      if (*why == Unseen::kStale && last != kLongAgo) blind.since = std::min(blind.since, last);
    }
  }
  return blind;
}

}  // namespace culprit
