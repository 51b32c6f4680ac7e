#include "replay/bag_replay.h"

#include <algorithm>
#include <utility>

namespace culprit::replay {
namespace {

Manager::Options bag_options(Time start) {
  Manager::Options options;
  options.autonomy = Autonomy::kAdvise;
  options.start = start;
  // A bag does not show nodes: none is absent because it was not seen.
  options.discovery = std::chrono::hours(24 * 365);
  return options;
}

template <class What>
const What* event_as(const Event& event) {
  return std::get_if<What>(&event.what);
}

}  // namespace

BagReplay::BagReplay(const RuleSet& rules, std::unique_ptr<const Planner> planner,
                     bag::BagReading& reading, Listener listener, BagStretch stretch)
    : rules_(rules),
      reading_(reading),
      listener_(std::move(listener)),
      stretch_(stretch),
      planner_(std::move(planner)),
      states_(rules.rules.size()) {
  for (std::size_t r = 0; r < states_.size(); ++r) states_[r].outcome.rule = RuleId(r);
}

void BagReplay::begin(const bag::BagMessage& message) {
  start_ = now_ = Time(Duration(message.at));
  start_clock_ = message.recorded_at;
  manager_.emplace(rules_, std::move(planner_), bag_options(*start_));
}

void BagReplay::step(const bag::BagMessage& message) {
  const Time now{Duration(message.at)};
  const bool is_first = !manager_;
  if (is_first) begin(message);
  ++messages_;
  observations_.clear();
  const bool is_after_hole = message.is_after_hole && !is_first && now > now_;
  if (is_after_hole) {
    if (listener_.on_hole)
      listener_.on_hole(now_, now, now_.time_since_epoch().count() + clock_offset_);
    observations_.push_back({now_, HearingLost{"the copy of the recording lacks messages"}});
    advance(now_, observations_);
    observations_.clear();
    was_known_.clear();
    for (State& each : states_) {
      was_known_.push_back(each.known_since.has_value());
      pause(each, now_);
    }
  }
  // A recording may have holes of hours; nobody waits in them for more than this.
  constexpr int kMostDeadlines = 100'000;
  for (int i = 0; i < kMostDeadlines && manager_->next_deadline() < now; ++i) {
    now_ = manager_->next_deadline();
    manager_->step(now_, {});
    take_events();
    if (!is_after_hole) note_triggers();
  }
  clock_offset_ = message.recorded_at - message.at;
  if (is_after_hole) {
    observations_.push_back({now, HearingRegained{}});
    for (std::size_t r = 0; r < states_.size(); ++r) {
      if (was_known_[r]) go_on(states_[r], now);
    }
  }
  reading_.read(message, observations_);
  if (listener_.on_observation) {
    for (const Observation& each : observations_)
      listener_.on_observation(each, message.recorded_at);
  }
  advance(now, observations_);
}

void BagReplay::advance(Time now, std::span<const Observation> observations) {
  now_ = now;
  manager_->step(now, observations);
  take_events();
  note_triggers();
}

void BagReplay::take_events() {
  for (const Event& event : manager_->events()) {
    if (const auto* detected = event_as<FailureDetected>(event)) {
      State& state = states_[detected->rule.index];
      state.is_on = true;
      state.on_since = event.at;
      state.lasted = Duration::zero();
      if (event.at >= stretch_.from) {
        ++state.outcome.times;
        if (!state.outcome.first) {
          state.outcome.first = event.at;
          state.outcome.first_clock = event.at.time_since_epoch().count() + clock_offset_;
        }
      }
    }
    if (const auto* resolved = event_as<FailureResolved>(event))
      end_failure(resolved->rule, event.at);
    if (const auto* lost = event_as<FailureLost>(event)) end_failure(lost->rule, event.at);
    if (event.at < stretch_.from) continue;
    decisions_ += event_as<StrategyChosen>(event) != nullptr ? 1 : 0;
    // Where a rule only reports, there is nothing to exhaust. Holes are told as such.
    const auto* exhausted = event_as<RuleExhausted>(event);
    const bool only_reports = exhausted != nullptr && rules_[exhausted->rule].strategies.empty();
    const bool is_hole = event_as<JudgementSuspended>(event) != nullptr ||
                         event_as<JudgementResumed>(event) != nullptr;
    if (listener_.on_event && !only_reports && !is_hole)
      listener_.on_event(event, event.at.time_since_epoch().count() + clock_offset_);
  }
}

Duration BagReplay::counted(Time from, Time until) const {
  const Time begin = std::max(from, stretch_.from);
  return until > begin ? until - begin : Duration::zero();
}

// When its trigger stopped being true, if it did. The failure is reported as cleared a little later.
std::optional<Time> BagReplay::trigger_over(RuleId rule) const {
  const Detection& detection = manager_->knowledge().states[rule].detection;
  const bool is_over = !detection.trigger.known || !detection.trigger.b;
  return is_over ? std::optional(detection.trigger_since) : std::nullopt;
}

void BagReplay::end_failure(RuleId rule, Time at) {
  State& state = states_[rule.index];
  if (!std::exchange(state.is_on, false)) return;
  // As long as the report of its end says, unless it was not seen again after a pause.
  const auto over = trigger_over(rule);
  const bool was_seen = state.on_since && (!over || *over > *state.on_since);
  if (was_seen) state.lasted += counted(*state.on_since, at);
  state.on_since.reset();
  state.outcome.longest = std::max(state.outcome.longest, state.lasted);
  state.outcome.total += state.lasted;
}

// From here on nobody knows whether it is there.
void BagReplay::pause(State& state, Time at) {
  if (state.on_since) state.lasted += counted(*state.on_since, at);
  state.on_since.reset();
  if (!state.known_since) return;
  state.outcome.known += counted(*state.known_since, at);
  state.outcome.was_known |= at >= stretch_.from;
  state.known_since.reset();
}

void BagReplay::go_on(State& state, Time at) {
  state.known_since = at;
  if (state.is_on) state.on_since = at;
}

void BagReplay::note_triggers() {
  const RuleStates& states = manager_->knowledge().states;
  for (std::size_t r = 0; r < states_.size(); ++r) {
    State& state = states_[r];
    const bool is_known = states[RuleId(r)].detection.trigger.known;
    if (is_known == state.known_since.has_value()) continue;
    if (listener_.on_judged)
      listener_.on_judged(RuleId(r), is_known, now_.time_since_epoch().count() + clock_offset_);
    if (is_known) {
      go_on(state, now_);
    } else {
      pause(state, now_);
    }
  }
}

std::vector<RuleOutcome> BagReplay::outcomes() const {
  std::vector<RuleOutcome> all;
  for (const State& state : states_) {
    RuleOutcome outcome = state.outcome;
    outcome.was_known |= state.known_since.has_value();
    if (state.known_since) outcome.known += counted(*state.known_since, now_);
    if (state.is_on) {
      const auto over = trigger_over(outcome.rule);
      outcome.is_on = !over || !state.on_since;
      const Duration lasted =
          state.lasted +
          (state.on_since ? counted(*state.on_since, over.value_or(now_)) : Duration::zero());
      outcome.longest = std::max(outcome.longest, lasted);
      outcome.total += lasted;
    }
    for (const InputId input : rules_[outcome.rule].inputs) {
      if (outcome.times == 0 && reading_.is_misread(input)) outcome.was_known = false;
      std::string why = reading_.why_unknown(input);
      const bool is_new = std::ranges::find(outcome.why_unknown, why) == outcome.why_unknown.end();
      if (!why.empty() && is_new) outcome.why_unknown.push_back(std::move(why));
    }
    all.push_back(std::move(outcome));
  }
  return all;
}

}  // namespace culprit::replay
