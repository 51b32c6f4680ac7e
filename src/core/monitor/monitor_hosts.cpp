// The monitor's part about computers, their clocks and what nodes log: which are heard of, and how far time can be
// trusted.
#include <algorithm>

#include "monitor/monitor.h"

namespace culprit {

void Monitor::on(Time at, const LogSeen& seen) {
  see(seen.component, at);
  for (const InputId id : component_inputs_[seen.component.index]) {
    const Input& input = knowledge_.rules[id];
    if (input.kind != Input::Kind::kLogs || seen.level < input.log_level) continue;
    write_.signals.set_arrivals(id, {at});
    if (!derived_[id.index].count.add(at, 1)) note_overflow(id, at);
    update(id, at);
  }
}

// The time from which its window is covered. Its node may have come later: until then it logged
// nothing.
Time Monitor::logs_known_from(InputId id) const {
  const Time since =
      std::max(heard_since(start_), derived_[id.index].overflowed.value_or(kLongAgo));
  return later(since, knowledge_.rules[id].window);
}

Slot Monitor::logs(InputId id, Time now) {
  Derived& derived = derived_[id.index];
  if (!knowledge_.discovered.has(knowledge_.rules[id].component) || now < logs_known_from(id))
    return {};
  derived.is_overflow_told = false;
  derived.count.advance(now);
  return Slot::of(static_cast<std::int64_t>(derived.count.count()));
}

Time Monitor::next_of_logs(InputId id, Time now) const {
  if (!knowledge_.discovered.has(knowledge_.rules[id].component)) return kNever;
  const monitor::SlidingCount& count = derived_[id.index].count;
  return now < logs_known_from(id) ? logs_known_from(id) : count.falls_below(count.count());
}

void Monitor::on(Time at, const HostReached& seen) {
  write_.components.set_out_of_reach(seen.component, !seen.is_reached);
  update_alive(seen.component, at, "its node left the graph");
}

bool Monitor::is_time_held(TopicId topic) const {
  const auto is_held = [&](ComponentId c) {
    return knowledge_.components[c].time_held.has_value();
  };
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const ComponentId component(c);
    if (knowledge_.graph.publishes(component, knowledge_.rules[topic]) &&
        (is_held(component) || std::ranges::any_of(knowledge_.graph.upstream(component), is_held)))
      return true;
  }
  return false;
}

// While it is held, triggers read no silence, and afterwards none of that time.
void Monitor::hold_topic(TopicId id, bool is_held, Time at) {
  Topic& topic = topics_[id.index];
  if (topic.held.has_value() == is_held) return;
  if (is_held) {
    topic.held = at;
  } else {
    resume(id, *topic.held, at);
    // No goal has run meanwhile.
    for (auto& [goal, state] : topic.goals.all)
      state.began += at - std::max(*topic.held, state.began);
    topic.held.reset();
    topic.loss.restart(at);
    for (const InputId input : topic.inputs) derived_[input.index].overflowed = at;
  }
  for (const InputId input : topic.inputs) update(input, at);
}

void Monitor::on(Time at, const TimeHeld& seen) {
  if (knowledge_.components[seen.component].time_held.has_value() == seen.is_held) return;
  write_.components.set_time_held(seen.component, seen.is_held ? std::optional(at) : std::nullopt);
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    if (topics_[t].held.has_value() != seen.is_held)
      hold_topic(TopicId(t), is_time_held(TopicId(t)), at);
  }
}

void Monitor::on(Time at, const HostHeard& seen) {
  if (seen.host.empty()) return;
  if (!seen.is_heard) return note_silent(seen.host, at);
  if (silent_hosts_.erase(seen.host) == 0) return;
  write_.events.tell(at, HostBack{seen.host});
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const ComponentId component(c);
    const ComponentState& state = knowledge_.components[component];
    if (state.host != seen.host || !state.host_silent) continue;
    deadlines_.set(return_of(component), later(at, state.alive == true ? kSpeaks : kReturn));
  }
}

// Only for a host where a component was seen to run: for an unknown name there is no report.
void Monitor::note_silent(const std::string& host, Time at) {
  HostSilent silent{host, {}, true};
  bool are_several = false;
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const ComponentId component(c);
    const ComponentState& state = knowledge_.components[component];
    if (state.host.empty() || !knowledge_.discovered.has(component)) continue;
    if (state.host != host) {
      are_several = true;
      silent.is_last &= state.host_silent.has_value();
      continue;
    }
    silent.components.push_back(component);
    // More than a few questions without an answer.
    if (state.missed_probes < kMissedProbes) write_.components[component].missed_since = at;
    write_.components[component].missed_probes = std::max(state.missed_probes, kMissedProbes);
    if (!state.host_silent) write_.components.set_host_silent(component, at);
    deadlines_.clear(return_of(component));
  }
  silent.is_last &= are_several;
  if (silent.components.empty()) return;
  if (silent_hosts_.insert(host).second) write_.events.tell(at, silent);
  for (const ComponentId component : silent.components)
    update_alive(component, at, "it does not answer");
}

void Monitor::on(Time at, const ClockStepped& seen) {
  write_.clock_step = {at, std::max(seen.by, -Duration::max())};
  write_.events.tell(at, Trouble{write_.clock_step->in_words()});
}

void Monitor::on(Time at, const LinkTrouble& seen) { write_.events.tell(at, Trouble{seen.text}); }

}  // namespace culprit
