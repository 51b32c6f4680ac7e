#include "replay/bag_replay.h"

#include <algorithm>

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
  }
  // A recording may have holes of hours; nobody waits in them for more than this.
  constexpr int kMostDeadlines = 100'000;
  for (int i = 0; i < kMostDeadlines && manager_->next_deadline() < now; ++i)
    advance(manager_->next_deadline(), {});
  clock_offset_ = message.recorded_at - message.at;
  if (is_after_hole) observations_.push_back({now, HearingRegained{}});
  reading_.read(message, observations_);
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
      state.since = event.at;
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

void BagReplay::end_failure(RuleId rule, Time at) {
  State& state = states_[rule.index];
  if (!state.since) return;
  // It is told a little after the trigger stopped being true.
  const Detection& detection = manager_->knowledge().states[rule].detection;
  const bool is_over = !detection.trigger.known || !detection.trigger.b;
  if (is_over && detection.trigger_since > *state.since) at = std::min(at, detection.trigger_since);
  const Duration lasted = counted(*state.since, at);
  state.outcome.longest = std::max(state.outcome.longest, lasted);
  state.outcome.total += lasted;
  state.since.reset();
}

void BagReplay::note_triggers() {
  const RuleStates& states = manager_->knowledge().states;
  for (std::size_t r = 0; r < states_.size(); ++r) {
    State& state = states_[r];
    const bool is_known = states[RuleId(r)].detection.trigger.known;
    if (is_known == state.known_since.has_value()) continue;
    if (is_known) {
      state.known_since = now_;
    } else {
      state.outcome.known += counted(*state.known_since, now_);
      state.outcome.was_known |= now_ >= stretch_.from;
      state.known_since.reset();
    }
  }
}

std::vector<RuleOutcome> BagReplay::outcomes() const {
  std::vector<RuleOutcome> all;
  for (const State& state : states_) {
    RuleOutcome outcome = state.outcome;
    outcome.was_known |= state.known_since.has_value();
    if (state.known_since) outcome.known += counted(*state.known_since, now_);
    if (state.since) {
      outcome.is_on = true;
      const Duration lasted = counted(*state.since, now_);
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
