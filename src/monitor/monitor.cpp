#include "monitor/monitor.h"

#include <algorithm>
#include <cmath>

namespace culprit {
namespace {

using Kind = Input::Kind;

// What comes seldom tells little about how fast it would show a change.
constexpr Duration kLongestLatency = std::chrono::seconds(5);

// A new interval counts for an eighth, as in TCP's round-trip estimate.
Duration smoothed(Duration before, Duration now) {
  return before == Duration::zero() ? now : before + (now - before) / 8;
}

Duration usual_latency(Duration interval) { return std::min(2 * interval, kLongestLatency); }

// Where `value` lies among `thresholds`: between which two, or on which one. No comparison changes
// its result while this stays the same.
std::size_t position(double value, const std::vector<double>& thresholds) {
  const auto above = std::lower_bound(thresholds.begin(), thresholds.end(), value);
  const auto below = static_cast<std::size_t>(above - thresholds.begin());
  return 2 * below + (above != thresholds.end() && *above == value ? 1 : 0);
}

double as_number(const Slot& slot, Type type) {
  return type == Type::kDuration ? seconds(Duration(slot.i)) : slot.d;
}

}  // namespace

Monitor::Monitor(Knowledge& knowledge, Time start, Time settled)
    : knowledge_(knowledge),
      start_(start),
      settled_(settled),
      topics_(knowledge.rules.topics.size()),
      signals_(knowledge.rules.signals.size()),
      derived_(knowledge.rules.inputs.size()),
      component_inputs_(knowledge.rules.components.size()),
      parameter_inputs_(knowledge.rules.parameters.size()),
      parameter_signals_(knowledge.rules.parameters.size()),
      diagnostic_inputs_(knowledge.rules.diagnostics.size()),
      deadlines_(knowledge.rules.inputs.size() + 1) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    const Input& input = rules.inputs[i];
    const InputId id(i);
    knowledge_.signals.set_latency(id, rules.cycle);
    switch (input.kind) {
      case Kind::kRate:
      case Kind::kAge:
      case Kind::kPhi:
        topics_[input.topic.index].inputs.push_back(id);
        topics_[input.topic.index].needs_phi |= input.kind == Kind::kPhi;
        if (input.kind == Kind::kRate) derived_[i].count = monitor::SlidingCount(input.window);
        for (const double threshold : input.thresholds) {
          if (input.kind == Kind::kPhi)
            derived_[i].deviations.push_back(monitor::PhiAccrual::deviations(threshold));
        }
        deadlines_.set(i, settled_);
        break;
      case Kind::kSignal:
      case Kind::kMean:
      case Kind::kMin:
      case Kind::kMax:
      case Kind::kStddev:
      case Kind::kChanged:
        signals_[input.signal.index].inputs.push_back(id);
        if (input.window > Duration::zero())
          derived_[i].values = monitor::SlidingValues(input.window);
        break;
      case Kind::kAlive:
      case Kind::kLifecycle:
        component_inputs_[input.component.index].push_back(id);
        break;
      case Kind::kParameter:
        parameter_inputs_[input.parameter.index].push_back(id);
        break;
      case Kind::kLevel:
        diagnostic_inputs_[input.diagnostic.index].push_back(id);
        break;
    }
  }
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    if (const auto* parameter = std::get_if<ParameterId>(&rules.signals[s].source)) {
      parameter_signals_[parameter->index].push_back(SignalId(s));
    }
  }
  deadlines_.set(rules.inputs.size(), settled_);
}

void Monitor::observe(const Observation& observation, Time at) {
  std::visit([&](const auto& seen) { on(at, seen); }, observation.what);
}

void Monitor::advance(Time now) {
  while (const auto due = deadlines_.pop_due(now)) {
    if (*due < knowledge_.rules.inputs.size()) {
      update(InputId(*due), now);
      continue;
    }
    for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c)
      update_alive(ComponentId(c), now, "");
  }
}

void Monitor::refresh(const Program& program, Time now) {
  for (const Instruction& instruction : program.code) {
    if (instruction.op == Op::kInput) update(InputId(instruction.operand), now);
  }
}

// ---- topics

void Monitor::on(Time at, const SampleArrived& seen) {
  Topic& topic = topics_[seen.topic.index];
  if (!topic.first) topic.first = at;
  if (topic.last)
    topic.interval = smoothed(topic.interval, (at - *topic.last) / std::max(1u, seen.published));
  topic.last = at;
  knowledge_.signals.set_rhythm(seen.topic, {at, topic.interval});
  if (topic.needs_phi) topic.phi.add(at, seen.published);
  for (const InputId id : topic.inputs) {
    const Input& input = knowledge_.rules[id];
    if (input.kind == Kind::kRate) derived_[id.index].count.add(at, seen.published);
    knowledge_.signals.set_latency(
        id, input.kind == Kind::kRate ? input.window : usual_latency(topic.interval));
    update(id, at);
  }
}

void Monitor::update(InputId id, Time now) {
  const Input& input = knowledge_.rules[id];
  Slot value;
  switch (input.kind) {
    case Kind::kRate:
      value = rate(id, now);
      break;
    case Kind::kAge:
      value = age(id, now);
      break;
    case Kind::kPhi:
      value = phi(id, now);
      break;
    case Kind::kChanged:
      return knowledge_.signals.set(id, Slot::of(false));
    case Kind::kMean:
    case Kind::kMin:
    case Kind::kMax:
    case Kind::kStddev:
      return update_window(id, now);
    case Kind::kSignal: {
      // Its deadline is its staleness. A refresh comes earlier and changes nothing.
      const auto& signal = signals_[input.signal.index];
      const auto stale = knowledge_.rules[input.signal].stale;
      if (stale && signal.last && later(*signal.last, *stale) <= now) knowledge_.signals.forget(id);
      return;
    }
    default:
      return;
  }
  const Slot& before = knowledge_.signals[id];
  const bool same_place = before.known && value.known && input.only_compared &&
                          position(as_number(before, input.type), input.thresholds) ==
                              position(as_number(value, input.type), input.thresholds);
  if (same_place) {
    knowledge_.signals.set_quietly(id, value);
  } else {
    knowledge_.signals.set(id, value);
  }
  deadlines_.set(id.index, next_crossing(id, now));
}

Slot Monitor::age(InputId id, Time now) const {
  const Topic& topic = topics_[knowledge_.rules[id].topic.index];
  if (topic.last) return Slot::of(now - *topic.last);
  return now >= settled_ ? Slot::of(now - start_) : Slot();
}

Slot Monitor::rate(InputId id, Time now) {
  const Input& input = knowledge_.rules[id];
  const Topic& topic = topics_[input.topic.index];
  const bool window_is_full = topic.first && later(*topic.first, input.window) <= now;
  if (topic.first ? !window_is_full : now < settled_) return {};
  derived_[id.index].count.advance(now);
  return Slot::of(derived_[id.index].count.rate());
}

Slot Monitor::phi(InputId id, Time now) const {
  const auto suspicion = topics_[knowledge_.rules[id].topic.index].phi.phi(now);
  return suspicion ? Slot::of(*suspicion) : Slot();
}

// The next time after `now` at which the input crosses a threshold if no message comes.
Time Monitor::next_crossing(InputId id, Time now) const {
  const Input& input = knowledge_.rules[id];
  const Topic& topic = topics_[input.topic.index];
  if (!topic.last && now < settled_) return settled_;
  if (input.readers.empty()) return kNever;
  if (!input.only_compared && input.kind != Kind::kRate) return later(now, knowledge_.rules.cycle);
  switch (input.kind) {
    case Kind::kAge:
      return next_age(input, now);
    case Kind::kPhi:
      return next_phi(id, now);
    default:
      if (topic.first && now < later(*topic.first, input.window))
        return later(*topic.first, input.window);
      return next_rate(id);
  }
}

Time Monitor::next_age(const Input& input, Time now) const {
  const Time since = topics_[input.topic.index].last.value_or(start_);
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

// ---- signals

void Monitor::on(Time at, const SignalRead& seen) { read_signal(seen.signal, seen.value, at); }

void Monitor::read_signal(SignalId signal, const Value& value, Time at) {
  const culprit::Signal& declared = knowledge_.rules[signal];
  Signal& state = signals_[signal.index];
  const bool is_first = !state.last;
  const bool had_rhythm = state.interval > Duration::zero();
  if (!is_first) state.interval = smoothed(state.interval, at - *state.last);
  const bool has_rhythm = state.interval > Duration::zero();
  state.last = at;
  std::string text;
  const Slot slot = as_type(value, declared.type, text);
  for (const InputId id : state.inputs) {
    const Input& input = knowledge_.rules[id];
    // After one reading nobody knows when the next will come.
    const Duration latency = has_rhythm ? usual_latency(state.interval) : kLongestLatency;
    knowledge_.signals.set_latency(id, latency + input.window);
    knowledge_.signals.set_read_at(id, at);
    if (has_rhythm && !had_rhythm) knowledge_.signals.touch(id);
    if (input.kind == Kind::kSignal) {
      note_reading(id, slot);
      knowledge_.signals.set(id, slot);
      if (declared.stale) deadlines_.set(id.index, later(at, *declared.stale));
    } else if (input.kind == Kind::kChanged) {
      Derived& derived = derived_[id.index];
      const bool differs = !is_first && derived.last_value != value;
      derived.last_value = value;
      if (differs) deadlines_.set(id.index, later(at, knowledge_.rules.cycle));
      if (differs || is_first) knowledge_.signals.set(id, Slot::of(differs));
    } else if (slot.known) {
      derived_[id.index].values.add(at, slot.d);
      update_window(id, at);
    }
  }
}

// A new extreme, or nearer to a threshold than it ever was lately?
void Monitor::note_reading(InputId id, const Slot& slot) {
  const Input& input = knowledge_.rules[id];
  const bool is_number = input.type == Type::kInt || input.type == Type::kDouble;
  if (!is_number || input.thresholds.empty() || !slot.known) return;
  const double value = input.type == Type::kInt ? static_cast<double>(slot.i) : slot.d;
  if (!std::isfinite(value)) return;
  monitor::Ring<double>& usual = derived_[id.index].usual;
  bool is_unusual = false;
  if (usual.size() >= kLeastReadings) {
    double least = usual[0];
    double most = usual[0];
    for (std::size_t i = 1; i < usual.size(); ++i) {
      least = std::min(least, usual[i]);
      most = std::max(most, usual[i]);
    }
    is_unusual = (value < least && input.thresholds.front() <= value) ||
                 (value > most && input.thresholds.back() >= value);
  }
  knowledge_.signals.set_unusual(id, is_unusual);
  if (usual.full()) usual.pop_front();
  usual.push_back(value);
}

void Monitor::update_window(InputId id, Time now) {
  Derived& derived = derived_[id.index];
  derived.values.advance(now);
  const auto summary = derived.values.summary();
  Slot value;
  if (summary) {
    switch (knowledge_.rules[id].kind) {
      case Kind::kMean:
        value = Slot::of(summary->mean);
        break;
      case Kind::kMin:
        value = Slot::of(summary->min);
        break;
      case Kind::kMax:
        value = Slot::of(summary->max);
        break;
      default:
        value = Slot::of(summary->stddev);
        break;
    }
  }
  knowledge_.signals.set(id, value);
  deadlines_.set(id.index, derived.values.next_change());
}

void Monitor::on(Time, const DiagnosticRead& seen) {
  for (const InputId id : diagnostic_inputs_[seen.diagnostic.index]) {
    knowledge_.signals.set(id, Slot::of(std::int64_t{seen.level}));
  }
}

void Monitor::on(Time at, const ParameterRead& seen) {
  knowledge_.components[seen.parameter] = seen.value;
  for (const SignalId signal : parameter_signals_[seen.parameter.index])
    read_signal(signal, seen.value, at);
  for (const InputId id : parameter_inputs_[seen.parameter.index]) {
    std::string text;
    knowledge_.signals.set(id, as_type(seen.value, knowledge_.rules[id].type, text));
  }
}

// ---- the graph and its components

void Monitor::on(Time at, const NodeAppeared& seen) {
  knowledge_.graph.node_appeared(seen.node);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (!component) return;
  ComponentState& state = knowledge_.components[*component];
  const bool same_process = seen.pid != 0 && seen.pid == state.node_pid && state.in_graph;
  if (!same_process) forget_process(*component, at);
  state.in_graph = true;
  state.node_seen = at;
  state.node_pid = seen.pid;
  state.missed_probes = 0;
  if (seen.pid != state.pid) state.process = ProcessState::kRunning;
  update_alive(*component, at, "");
}

void Monitor::on(Time at, const NodeVanished& seen) {
  knowledge_.graph.node_vanished(seen.node);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (!component) return;
  forget_process(*component, at);
  update_alive(*component, at, "its node left the graph");
}

void Monitor::on(Time, const NamesakesSeen& seen) {
  const auto component = knowledge_.graph.component_of(seen.node);
  if (component) knowledge_.components[*component].namesakes = seen.others;
}

void Monitor::on(Time, const EndpointAppeared& seen) {
  knowledge_.graph.endpoint_appeared(seen.node, seen.kind, seen.name);
}

void Monitor::on(Time, const EndpointVanished& seen) {
  knowledge_.graph.endpoint_vanished(seen.node, seen.kind, seen.name);
}

void Monitor::on(Time, const LifecycleRead& seen) {
  ComponentState& state = knowledge_.components[seen.component];
  state.lifecycle = seen.state;
  const bool is_primary = seen.state != Lifecycle::kUnknown && seen.state != Lifecycle::kTransition;
  if (is_primary && knowledge_.states.reservation(seen.component) == nullptr)
    state.intended_lifecycle = seen.state;
  for (const InputId id : component_inputs_[seen.component.index]) {
    if (knowledge_.rules[id].kind != Kind::kLifecycle) continue;
    knowledge_.signals.set(id, is_primary ? Slot::of(to_string(seen.state)) : Slot());
  }
}

void Monitor::on(Time at, const ProcessSeen& seen) {
  ComponentState& state = knowledge_.components[seen.component];
  // A word about a process that the node no longer runs in says nothing about the node.
  const bool is_other = seen.pid != 0 && state.node_pid != 0 && seen.pid != state.node_pid;
  if (is_other && state.in_graph && seen.state != ProcessState::kRunning) return;
  state.process = seen.state;
  state.pid = seen.pid;
  state.process_remark = seen.remark;
  if (seen.state == ProcessState::kGone) {
    knowledge_.graph.node_vanished(knowledge_.graph.node_name(seen.component));
    forget_process(seen.component, at);
  }
  update_alive(seen.component, at,
               seen.state == ProcessState::kStopped ? "its process is stopped" : seen.remark);
}

void Monitor::on(Time at, const Probed& seen) {
  ComponentState& state = knowledge_.components[seen.component];
  state.missed_probes = seen.answered ? 0 : state.missed_probes + 1;
  update_alive(seen.component, at, "it does not answer");
}

void Monitor::on(Time at, const LinkTrouble& seen) { knowledge_.tell(at, Trouble{seen.text}); }

// The node or its process is gone or is another now: what was known of it does not hold any more.
void Monitor::forget_process(ComponentId component, Time at) {
  ComponentState& state = knowledge_.components[component];
  state.in_graph = false;
  state.node_pid = 0;
  on(at, LifecycleRead{component, Lifecycle::kUnknown});
  for (std::size_t p = 0; p < knowledge_.rules.parameters.size(); ++p) {
    if (knowledge_.rules.parameters[p].component != component) continue;
    knowledge_.components[ParameterId(p)].reset();
    for (const InputId id : parameter_inputs_[p]) knowledge_.signals.forget(id);
  }
}

void Monitor::update_alive(ComponentId component, Time at, const std::string& remark) {
  ComponentState& state = knowledge_.components[component];
  const bool is_alive = state.in_graph && state.process == ProcessState::kRunning &&
                        state.missed_probes < kMissedProbes;
  if (!is_alive && !state.alive && at < settled_) return;  // it may still be discovered
  if (state.alive == is_alive) return;
  const bool was_known = state.alive.has_value();
  state.alive = is_alive;
  if (is_alive) {
    knowledge_.tell(at, ComponentFound{component, state.node_pid});
  } else {
    knowledge_.tell(at, ComponentLost{component, was_known ? remark : "it was never seen"});
  }
  for (const InputId id : component_inputs_[component.index]) {
    if (knowledge_.rules[id].kind == Kind::kAlive) knowledge_.signals.set(id, Slot::of(is_alive));
  }
}

}  // namespace culprit
