// The monitor's part about the graph and its components: which are there, and which are alive.
#include "monitor/monitor.h"

namespace culprit {

namespace {

using Kind = Input::Kind;

}  // namespace

void Monitor::on(Time at, const NodeAppeared& seen) {
  knowledge_.graph.node_appeared(seen.node);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (!component) return;
  knowledge_.sightings.note(*component, at);
  ComponentState& state = knowledge_.components[*component];
  const bool same_process = seen.pid != 0 && seen.pid == state.node_pid && state.in_graph;
  if (!same_process) forget_process(*component, at);
  state.in_graph = true;
  state.is_missed = false;
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

void Monitor::on(Time at, const EndpointAppeared& seen) {
  knowledge_.graph.endpoint_appeared(seen.node, seen.kind, seen.name);
  if (seen.kind != EndpointKind::kPublisher) return;
  const auto topic = topic_ids_.find(seen.name);
  if (topic != topic_ids_.end()) see(topic->second, at);
}

void Monitor::on(Time, const EndpointVanished& seen) {
  knowledge_.graph.endpoint_vanished(seen.node, seen.kind, seen.name);
}

void Monitor::remember(const Past& past) {
  for (const Event& event : past) {
    if (const auto* intended = std::get_if<LifecycleIntended>(&event.what))
      knowledge_.components[intended->component].intended_lifecycle = intended->state;
  }
}

void Monitor::on(Time at, const LifecycleRead& seen) {
  ComponentState& state = knowledge_.components[seen.component];
  state.lifecycle = seen.state;
  const bool is_primary = seen.state != Lifecycle::kUnknown && seen.state != Lifecycle::kTransition;
  if (is_primary && !state.took_place && knowledge_.states.reservation(seen.component) == nullptr)
    knowledge_.intend_lifecycle(seen.component, seen.state, at);
  if (seen.state != Lifecycle::kUnknown) state.took_place = false;
  for (const InputId id : component_inputs_[seen.component.index]) {
    if (knowledge_.rules[id].kind != Kind::kLifecycle) continue;
    knowledge_.signals.set(id, is_primary ? Slot::of(to_string(seen.state)) : Slot());
  }
}

void Monitor::on(Time at, const ProcessSeen& seen) {
  ComponentState& state = knowledge_.components[seen.component];
  // A word about a process that the node no longer runs in says nothing about the node.
  const int present = state.node_pid != 0 ? state.node_pid : state.pid;
  const bool is_other = seen.pid != 0 && seen.pid != present;
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
  if (is_deaf_ && !seen.answered) return;
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
  if (state.lifecycle != Lifecycle::kUnknown) state.took_place = true;
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
  if (!knowledge_.sightings.has(component)) return;        // it may be a name that nobody has
  if (!is_alive && !state.alive && at < settled_) return;  // it may still be discovered
  const bool may_be_unheard = is_deaf_ || at < graced_;
  if (!is_alive && may_be_unheard && state.process == ProcessState::kRunning) {
    state.alive.reset();
    return update_alive_inputs(component, Slot());
  }
  if (state.alive == is_alive) return;
  state.alive = is_alive;
  if (is_alive) {
    knowledge_.tell(at, ComponentFound{component, state.node_pid});
  } else {
    knowledge_.tell(at, ComponentLost{component, remark});
  }
  update_alive_inputs(component, Slot::of(is_alive));
}

void Monitor::update_alive_inputs(ComponentId component, const Slot& value) {
  for (const InputId id : component_inputs_[component.index]) {
    if (knowledge_.rules[id].kind == Kind::kAlive) knowledge_.signals.set(id, value);
  }
}

}  // namespace culprit
