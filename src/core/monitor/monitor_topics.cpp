// The monitor's part about topics: when a message came, and what time alone makes of that.
#include <algorithm>
#include <cmath>

#include "monitor/interval.h"
#include "monitor/monitor.h"

namespace culprit {

namespace {

using Kind = Input::Kind;

// A message comes after `interval`. The first of several slow ones ends no silence: they are all as late.
void note_silence(SignalStore::Rhythm& rhythm, Duration interval, Time at) {
  constexpr int kGaps = SignalStore::Rhythm::kSilentGaps;
  auto& silence = rhythm.silence;
  const bool is_next = silence && silence->over == *rhythm.last;
  if (is_next && interval > kGaps * silence->gap && 2 * interval >= silence->over - silence->since)
    silence.reset();
  const Duration before = rhythm.gap;
  rhythm.gap = monitor::usual_gap(before, interval);
  if (before > Duration::zero() && interval > SignalStore::Rhythm::kUsualPause * before)
    silence = {*rhythm.last, at, before};
}

// A message comes after `interval`. A pace that has lasted for longer than any rule of the topic looks back is the usual one.
void note_pace(SignalStore::Rhythm& rhythm, Duration interval, Duration looked_back) {
  auto& slowing = rhythm.slowing;
  const Duration lasting = std::max(SignalStore::Rhythm::kSlowAtMost, looked_back);
  if (slowing && *rhythm.last > later(slowing->since, lasting)) slowing.reset();
  const Duration usual = slowing ? slowing->gap : rhythm.gap;
  const bool is_slow = usual > Duration::zero() &&
                       seconds(interval) > SignalStore::Rhythm::kSlowPace * seconds(usual);
  if (is_slow) {
    if (!slowing) slowing = {*rhythm.last, usual};
    slowing->in_time = std::max(slowing->in_time - 1, 0);
  } else if (slowing && ++slowing->in_time == SignalStore::Rhythm::kBackInPace) {
    slowing.reset();
  }
}

}  // namespace

using monitor::smoothed;
using monitor::usual_latency;

void Monitor::on(Time at, const SampleArrived& seen) {
  write_.discovered.note(seen.topic, at);
  write_.discovered.receive(seen.topic);
  Topic& topic = topics_[seen.topic.index];
  if (!topic.first) topic.first = at;
  if (!topic.regained) topic.regained = at;
  SignalStore::Rhythm rhythm = knowledge_.signals.rhythm(seen.topic);
  topic.resumes.reset();
  rhythm.resumed = kLongAgo;
  if (rhythm.last && *rhythm.last >= awake_) {
    const Duration interval = (at - *rhythm.last) / std::max(1u, seen.published);
    note_pause(rhythm, interval, seen.topic);
    rhythm.interval = smoothed(rhythm.interval, interval);
    note_pace(rhythm, interval, topic.looked_back);
    note_silence(rhythm, interval, at);
  }
  rhythm.last = topic.last = at;
  topic.loss.add(at, seen.published, seen.lost_here);
  rhythm.loss = topic.loss.share_with_ours(at).value_or(0);
  rhythm.loss_at_most = topic.loss.at_most(at);
  write_.signals.set_rhythm(seen.topic, rhythm);
  if (topic.needs_phi) topic.phi.add(at, seen.published);
  for (const InputId id : topic.inputs) {
    const Input& input = knowledge_.rules[id];
    if (input.kind == Kind::kRate && !derived_[id.index].count.add(at, seen.published))
      note_overflow(id, at);
    const bool counts = input.kind == Kind::kRate || input.kind == Kind::kGoals;
    write_.signals.set_latency(id, counts                      ? input.window
                                   : input.kind == Kind::kLoss ? 2 * monitor::LossMeter::kSpan
                                                               : usual_latency(rhythm.interval));
    update(id, at);
    // A topic that was known to be silent made triggers true without any change of their inputs.
    if (topic.is_known_silent) write_.signals.touch(id);
  }
  if (!knowledge_.components.is_any_known_dead()) topic.is_known_silent = false;
}

void Monitor::note_pause(SignalStore::Rhythm& rhythm, Duration interval, TopicId topic) const {
  const bool is_unusual =
      rhythm.gap > Duration::zero() && interval > SignalStore::Rhythm::kUsualPause * rhythm.gap;
  if (!is_unusual) rhythm.flowed += interval;
  if (!is_unusual && interval <= rhythm.longest) return;
  if (has_begun_since(*rhythm.last, topic)) return;
  if (is_unusual) rhythm.paused += interval;
  rhythm.longest = std::max(rhythm.longest, interval);
}

// Did a publisher of the topic, or something that this depends on, begin anew? Either keeps the topic silent for a while.
bool Monitor::has_begun_since(Time before, TopicId topic) const {
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const ComponentId publisher(c);
    if (knowledge_.graph.publishes(publisher, knowledge_.rules[topic]) &&
        has_begun_since(before, publisher))
      return true;
  }
  return false;
}

bool Monitor::has_begun_since(Time before, ComponentId sender) const {
  const auto is_new = [&](ComponentId component) {
    const ComponentState& state = knowledge_.components[component];
    return state.node_seen >= before ||
           (state.lifecycle_since != kLongAgo && state.lifecycle_since >= before);
  };
  return is_new(sender) || std::ranges::any_of(knowledge_.graph.upstream(sender), is_new);
}

void Monitor::see(TopicId topic, Time at) {
  if (!write_.discovered.note(topic, at)) return;
  for (const InputId id : topics_[topic.index].inputs) {
    const Kind kind = knowledge_.rules[id].kind;
    const bool is_of_goals = kind == Kind::kGoals || kind == Kind::kGoalAge;
    deadlines_.set(id.index, is_of_goals ? at : silent_from(topic));
  }
}

Time Monitor::silent_from(TopicId topic) const {
  if (const auto& since = topics_[topic.index].silent_since) return *since;
  const auto first = knowledge_.discovered.first(topic);
  return first ? later(std::max({*first, start_, awake_}), discovered_ - start_) : kNever;
}

// For a topic that was seen and from which no message has come.
Time Monitor::listened_since(TopicId topic) const {
  return topics_[topic.index].silent_since.value_or(
      std::max({*knowledge_.discovered.first(topic), start_, awake_}));
}

// From when on its rate is known although it has not spoken.
Time Monitor::zero_from(const Input& input) const {
  const auto& since = topics_[input.topic.index].silent_since;
  return since ? later(heard_since(*since), input.window) : silent_from(input.topic);
}

// The time from which its window is covered: culprit listened all the time, and the topic had its
// first sample, or is known to be silent. A topic that is received again in time after a gap in
// reception counts as one that is received for the first time.
Time Monitor::rate_known_from(InputId id) const {
  const Input& input = knowledge_.rules[id];
  const Topic& topic = topics_[input.topic.index];
  if (!topic.first) {
    const Time from = std::max(zero_from(input), later(awake_, input.window));
    return topic.resumes ? std::max(from, topic.resumes->at) : from;
  }
  Time since = heard_since(*topic.first);
  const Time by =
      std::max(later(awake_, input.window), knowledge_.signals.rhythm(input.topic).heard_again_by);
  if (since == awake_ && topic.regained && *topic.regained < by) since = *topic.regained;
  if (const auto& overflowed = derived_[id.index].overflowed) since = std::max(since, *overflowed);
  const Time from = later(since, input.window);
  return topic.resumes ? std::max(from, topic.resumes->at) : from;
}

// How long no sample came although it would have been received. @pre it had a sample, or was seen
Duration Monitor::silence_of(TopicId id, Time now) const {
  const Topic& topic = topics_[id.index];
  if (topic.resumes)
    return topic.resumes->silence + std::max(now - topic.resumes->at, Duration::zero());
  return now - (topic.last ? *topic.last : listened_since(id));
}

void Monitor::resume(TopicId id, Time since, Time now) {
  Topic& topic = topics_[id.index];
  if (!topic.last && !topic.silent_since && !knowledge_.discovered.first(id)) return;
  SignalStore::Rhythm rhythm = knowledge_.signals.rhythm(id);
  rhythm.heard_again_by = later(now, rhythm.gap + kSpeaksAgain);
  write_.signals.set_rhythm(id, rhythm);
  hold_silence(id, since, rhythm.heard_again_by);
}

// Its silence is as long as it was at `since` until then, and goes on.
void Monitor::hold_silence(TopicId id, Time since, Time until) {
  Topic& topic = topics_[id.index];
  const Duration silence = std::max(silence_of(id, since), Duration::zero());
  topic.resumes = Topic::Resumes{until, silence};
  topic.phi.restart(until, silence);
  SignalStore::Rhythm rhythm = knowledge_.signals.rhythm(id);
  rhythm.resumed = until - silence;
  write_.signals.set_rhythm(id, rhythm);
}

void Monitor::stand_still(Time since, Time until) {
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    const Topic& topic = topics_[t];
    if (!topic.last) continue;
    const Duration held =
        topic.resumes ? topic.resumes->at - topic.resumes->silence - *topic.last : Duration::zero();
    if (held + (until - since) > kSpeaksAgain) continue;
    hold_silence(TopicId(t), since, topic.resumes ? std::max(topic.resumes->at, until) : until);
    for (const InputId id : topic.inputs) {
      const Kind kind = knowledge_.rules[id].kind;
      if (kind == Kind::kAge || kind == Kind::kPhi) update(id, since);
    }
  }
}

Slot Monitor::age(InputId id, Time now) const {
  const TopicId topic = knowledge_.rules[id].topic;
  if (!topics_[topic.index].last && now < silent_from(topic)) return {};
  return Slot::of(silence_of(topic, now));
}

Slot Monitor::rate(InputId id, Time now) {
  if (now < rate_known_from(id)) return {};
  Derived& derived = derived_[id.index];
  derived.is_overflow_told = false;
  derived.count.advance(now);
  return Slot::of(derived.count.rate());
}

// Each message has all goals that the server remembers. A goal that was over before the first message
// does not count.
void Monitor::on(Time at, const GoalsSeen& seen) {
  Goals& goals = topics_[seen.topic.index].goals;
  see(seen.topic, at);
  std::unordered_map<std::uint64_t, Goal> known;
  for (const GoalsSeen::Goal& each : seen.goals) {
    const auto before = goals.all.find(each.id);
    const bool is_new = before == goals.all.end();
    const Goal goal = is_new ? Goal{at, GoalStatus::kUnknown} : before->second;
    known.insert_or_assign(each.id, Goal{goal.began, each.status});
    if (is_new && goals.is_heard) count_goal(seen.topic, GoalStatus::kAccepted, at);
    const bool ends = is_over(each.status) && !is_over(goal.status);
    if (!ends || (is_new && !goals.is_heard)) continue;
    count_goal(seen.topic, each.status, at);
    if (each.status == GoalStatus::kSucceeded) {
      for (const InputId id : topics_[seen.topic.index].inputs) write_.signals.set_read_at(id, at);
    }
  }
  goals.is_heard = true;
  goals.all = std::move(known);
  for (const InputId id : topics_[seen.topic.index].inputs) update(id, at);
}

void Monitor::count_goal(TopicId topic, GoalStatus outcome, Time at) {
  for (const InputId id : topics_[topic.index].inputs) {
    const Input& input = knowledge_.rules[id];
    if (input.kind != Kind::kGoals || input.outcome != outcome) continue;
    write_.signals.set_arrivals(id, {at});
    if (!derived_[id.index].count.add(at, 1)) note_overflow(id, at);
  }
}

// Its server exited, and its goals with it. The next one reports its own.
void Monitor::forget_goals(TopicId topic, Time now) {
  Goals& goals = topics_[topic.index].goals;
  if (goals.all.empty()) return;
  goals.all.clear();
  for (const InputId id : topics_[topic.index].inputs) update(id, now);
}

// How long it has been listened to the status of the action; empty: its server was never seen.
std::optional<Time> Monitor::goals_known_since(TopicId topic) const {
  const auto first = knowledge_.discovered.first(topic);
  return first ? std::optional(heard_since(std::max(*first, start_))) : std::nullopt;
}

Slot Monitor::goals(InputId id, Time now) {
  const Input& input = knowledge_.rules[id];
  Derived& derived = derived_[id.index];
  const auto since = goals_known_since(input.topic);
  const Time counted = std::max(since.value_or(kLongAgo), derived.overflowed.value_or(kLongAgo));
  if (!since || now < later(counted, input.window)) return {};
  derived.is_overflow_told = false;
  derived.count.advance(now);
  return Slot::of(static_cast<std::int64_t>(derived.count.count()));
}

Slot Monitor::goal_age(TopicId topic, Time now) const {
  if (!goals_known_since(topic)) return {};
  const auto oldest = oldest_goal(topic);
  return Slot::of(oldest ? now - heard_since(*oldest) : Duration::zero());
}

// When the oldest goal that is not over began; empty: none runs.
std::optional<Time> Monitor::oldest_goal(TopicId topic) const {
  std::optional<Time> oldest;
  for (const auto& [id, goal] : topics_[topic.index].goals.all) {
    if (!is_over(goal.status) && (!oldest || goal.began < *oldest)) oldest = goal.began;
  }
  return oldest;
}

Time Monitor::next_of_goals(InputId id, Time now) const {
  const Input& input = knowledge_.rules[id];
  const auto since = goals_known_since(input.topic);
  if (!since) return kNever;
  if (input.kind == Kind::kGoals) {
    const Time counted = std::max(*since, derived_[id.index].overflowed.value_or(kLongAgo));
    const monitor::SlidingCount& count = derived_[id.index].count;
    return now < later(counted, input.window) ? later(counted, input.window)
                                              : count.falls_below(count.count());
  }
  const auto oldest = oldest_goal(input.topic);
  if (!oldest || input.readers.empty()) return kNever;
  if (!input.only_compared) return later(now, knowledge_.rules.cycle);
  for (const double threshold : input.thresholds) {
    const Time crossing = later(heard_since(*oldest), from_seconds(threshold) + Duration(1));
    if (crossing > now) return crossing;
  }
  return kNever;
}

Slot Monitor::phi(InputId id, Time now) const {
  const auto suspicion = topics_[knowledge_.rules[id].topic.index].phi.phi(now);
  return suspicion ? Slot::of(*suspicion) : Slot();
}

Slot Monitor::loss(InputId id, Time now) {
  const auto share = topics_[knowledge_.rules[id].topic.index].loss.share(now);
  return share ? Slot::of(*share) : Slot();
}

// The next time after `now` at which the input crosses a threshold if no message comes.
Time Monitor::next_crossing(InputId id, Time now) const {
  const Input& input = knowledge_.rules[id];
  if (input.kind == Kind::kGoals || input.kind == Kind::kGoalAge) return next_of_goals(id, now);
  if (input.kind == Kind::kLogs) return next_of_logs(id, now);
  const Topic& topic = topics_[input.topic.index];
  if (input.kind == Kind::kLoss) return topic.loss.changes();
  if (!topic.last && now < silent_from(input.topic)) return silent_from(input.topic);
  if (input.readers.empty()) return kNever;
  if (!input.only_compared && input.kind != Kind::kRate) return later(now, knowledge_.rules.cycle);
  switch (input.kind) {
    case Kind::kAge:
      return next_age(input, now);
    case Kind::kPhi:
      return next_phi(id, now);
    default:
      return now < rate_known_from(id) ? rate_known_from(id) : next_rate(id);
  }
}

Time Monitor::next_age(const Input& input, Time now) const {
  const Topic& topic = topics_[input.topic.index];
  const Time since = topic.resumes ? topic.resumes->at - topic.resumes->silence
                     : topic.last  ? *topic.last
                                   : listened_since(input.topic);
  for (const double threshold : input.thresholds) {
    // One nanosecond on: `age > threshold` must hold then.
    const Time crossing = later(since, from_seconds(threshold) + Duration(1));
    if (crossing > now) return crossing;
  }
  return kNever;
}

Time Monitor::next_phi(InputId id, Time now) const {
  for (const double deviations : derived_[id.index].deviations) {
    const Time crossing = topics_[knowledge_.rules[id].topic.index].phi.exceeds(deviations);
    if (crossing > now) return crossing;
  }
  return kNever;
}

Time Monitor::next_rate(InputId id) const {
  const Input& input = knowledge_.rules[id];
  const monitor::SlidingCount& count = derived_[id.index].count;
  if (!input.only_compared) return count.falls_below(count.count());
  const double rate = count.rate();
  const auto above = std::upper_bound(input.thresholds.begin(), input.thresholds.end(), rate);
  if (above == input.thresholds.begin()) return kNever;
  const double threshold = *(above - 1);
  if (rate == threshold) return count.falls_below(count.count());
  const double at_threshold = std::floor(threshold * seconds(input.window));
  return at_threshold < 0 ? kNever
                          : count.falls_below(static_cast<std::uint64_t>(at_threshold) + 1);
}

}  // namespace culprit
