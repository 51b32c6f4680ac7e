#include "rca_study/plant.h"

#include <algorithm>
#include <queue>

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

// A slow component is late before it is missed.
constexpr Duration kSlowness = 1s;
constexpr Duration kFlapsOn = 3s;
constexpr Duration kFlapsOff = 1500ms;

}  // namespace

Plant::Plant(const RcaScenario& scenario)
    : scenario_(scenario),
      states_(scenario.components.size()),
      to_come_(scenario.faults.size() + scenario.common_causes.size()) {
  simulation::Random random(simulation::mix(scenario.seed));
  for (const RcaTopic& topic : scenario.topics) {
    for (const Subscription& s : topic.subscribers) {
      const bool passes = random.chance(s.passes);
      if (s.is_redundant) states_[s.component].redundant += topic.publishers.size();
      if (!passes) continue;
      for (const std::size_t publisher : topic.publishers)
        states_[publisher].ways.push_back({s.component, from_seconds(s.delay_s), s.is_redundant});
    }
  }
  for (const InjectedFault& fault : scenario.faults)
    at(Time(from_seconds(fault.at_s)), [this, &fault] { inject(fault); });
  for (const CommonCause& cause : scenario.common_causes) {
    at(Time(from_seconds(cause.at_s)), [this, &cause] {
      --to_come_;
      hit(cause, 1);
    });
    at(Time(from_seconds(cause.at_s + cause.lasts_s)), [this, &cause] { hit(cause, -1); });
  }
}

bool Plant::step(Time until) {
  if (agenda_.next() > until) {
    if (until != kNever) now_ = std::max(now_, until);
    return false;
  }
  now_ = agenda_.next();
  agenda_.take()();
  return true;
}

void Plant::inject(const InjectedFault& fault) {
  State& state = states_[fault.component];
  --to_come_;
  if (!state.fault) ++faults_;
  state.fault = fault.kind;
  state.shows = true;
  if (fault.kind == FaultKind::kFlapping) after(kFlapsOn, [this, c = fault.component] { flap(c); });
  if (on_fault) on_fault(fault.component);
  update();
}

void Plant::flap(std::size_t component) {
  State& state = states_[component];
  if (state.fault != FaultKind::kFlapping) return;
  state.shows = !state.shows;
  after(state.shows ? kFlapsOn : kFlapsOff, [this, component] { flap(component); });
  update();
}

void Plant::hit(const CommonCause& cause, int change) {
  states_[cause.first].hits += change;
  states_[cause.second].hits += change;
  update();
}

void Plant::set_down(std::size_t component, bool is_down) {
  states_[component].is_down = is_down;
  update();
}

void Plant::repair(std::size_t component) {
  if (!states_[component].fault) return;
  --faults_;
  states_[component].fault.reset();
  states_[component].shows = false;
  update();
}

// The time until each component is ill if nothing changes any more: Dijkstra's algorithm from those
// that are ill by themselves. Empty: it is well then.
std::vector<std::optional<Duration>> Plant::onsets() const {
  using Item = std::pair<Duration, std::size_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
  std::vector<std::optional<Duration>> onset(states_.size());
  std::vector<std::size_t> redundant(states_.size(), 0);
  for (std::size_t c = 0; c < states_.size(); ++c) {
    if (states_[c].shows || states_[c].is_down || states_[c].hits > 0)
      open.emplace(Duration::zero(), c);
  }
  while (!open.empty()) {
    const auto [at, c] = open.top();
    open.pop();
    if (onset[c]) continue;
    onset[c] = at;
    const bool is_slow = states_[c].shows && states_[c].fault == FaultKind::kSlow;
    for (const Way& way : states_[c].ways) {
      if (onset[way.to]) continue;
      if (way.is_redundant && ++redundant[way.to] < states_[way.to].redundant) continue;
      open.emplace(at + way.delay + (is_slow ? kSlowness : Duration::zero()), way.to);
    }
  }
  return onset;
}

void Plant::update() {
  const auto onset = onsets();
  for (std::size_t c = 0; c < states_.size(); ++c) {
    State& state = states_[c];
    const bool will_be = state.coming.value_or(state.is_ill);
    if (onset[c].has_value() == will_be) {
      const bool is_source = onset[c] == Duration::zero() && !state.is_ill;
      if (!is_source) continue;
    }
    if (onset[c].has_value() == state.is_ill) {
      state.coming.reset();  // what was coming does not come
      ++state.change;
    } else {
      if (onset[c]) state.lag = *onset[c];
      become(c, onset[c].has_value(), state.lag);
    }
  }
}

void Plant::become(std::size_t component, bool is_ill, Duration delay) {
  State& state = states_[component];
  state.coming = is_ill;
  const auto change = [this, component, is_ill, number = ++state.change] {
    State& changed = states_[component];
    if (changed.change != number) return;
    if (on_change) on_change(component);
    changed.coming.reset();
    changed.is_ill = is_ill;
    is_ill ? ++ill_ : --ill_;
    after(from_seconds(scenario_.components[component].detector.latency_s),
          [this, component, is_ill] { states_[component].looks_ill = is_ill; });
  };
  delay == Duration::zero() ? change() : after(delay, change);
}

bool Plant::passes(std::size_t from, std::size_t to) const {
  std::vector<bool> is_visited(states_.size(), false);
  std::vector<std::size_t> open{from};
  is_visited[from] = true;
  while (!open.empty()) {
    const std::size_t c = open.back();
    open.pop_back();
    if (c == to) return true;
    for (const Way& way : states_[c].ways) {
      if (is_visited[way.to]) continue;
      is_visited[way.to] = true;
      open.push_back(way.to);
    }
  }
  return false;
}

}  // namespace culprit::study::rca
