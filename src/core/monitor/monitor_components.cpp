// The monitor's part about the graph and its components: which are there, and which are alive.
#include <algorithm>
#include <utility>

#include "knowledge/group_health.h"
#include "monitor/monitor.h"

namespace culprit {

namespace {

using Kind = Input::Kind;

// Not ended by somebody (ProcessSeen::remark): it gave up by itself, or was aborted.
bool has_crashed(const std::string& remark) {
  return remark == "killed by signal 6" ||
         (remark.starts_with("exit code ") && remark != "exit code 0");
}

// For a component with another driver, whose transition time was never seen.
constexpr Duration kUnknownTransition = std::chrono::minutes(1);

// For a node that shows no sign of life but its running process: a busy one misses some.
constexpr int kMissedAlone = 5;

// It alone publishes a topic that rules watch, with a rhythm that is known.
bool is_heard_of(ComponentId component, const Knowledge& knowledge) {
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const Topic& topic = knowledge.rules.topics[t];
    if (knowledge.signals.rhythm(TopicId(t)).longest > Duration::zero() &&
        knowledge.graph.publishes(component, topic) && knowledge.graph.publisher_count(topic) == 1)
      return true;
  }
  return false;
}

void set_process(ComponentState& state, ProcessState process, Time at) {
  if (state.process != process) state.process_since = at;
  state.process = process;
}

// A managed node makes its ends when it is configured.
bool is_up(Lifecycle state) {
  return state == Lifecycle::kActive || state == Lifecycle::kInactive ||
         state == Lifecycle::kFinalized;
}

}  // namespace

void Monitor::on(Time at, const NodeAppeared& seen) {
  const auto known = knowledge_.graph.component_of(seen.node);
  const bool had_part =
      known && knowledge_.graph.has_several_nodes(*known) && knowledge_.graph.has_any_node(*known);
  write_.graph.node_appeared(seen.node);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (!component) return;
  see(*component, at);
  if (seen.pid != 0) on(at, LivesOn{*component, ""});
  ComponentState& state = write_.components[*component];
  const bool was_in_graph = state.in_graph;
  const bool joins_part = had_part && !was_in_graph && seen.pid == state.node_pid;
  const bool same_process =
      joins_part || (seen.pid != 0 && seen.pid == state.node_pid && was_in_graph);
  const bool was_another = seen.pid != 0 && state.node_pid != 0 && !same_process && was_in_graph;
  if (!same_process) forget_process(*component, at);
  state.in_graph = knowledge_.graph.is_present(*component);
  state.is_missed = false;
  state.node_seen = at;
  state.node_pid = seen.pid;
  state.missed_probes = 0;
  part_misses_[component->index].clear();
  if (seen.pid != state.pid || seen.pid == 0) set_process(state, ProcessState::kRunning, at);
  // On another computer, or in a container: no process of it is reported.
  if (seen.pid == 0 && knowledge_.departures.stays_down(*component))
    write_.departures.arrived(*component, 0, at, Departures::By::kOther);
  write_.departures.loaded(*component, at);
  if (state.process == ProcessState::kRunning) note_no_longer_dead(*component);
  if (!same_process || !was_in_graph) await_ends(*component, at);
  if (!state.in_graph) return;  // the others have as long to come as its ends
  const bool was_alive = state.alive == true;
  update_alive(*component, at, "");
  // A mode manager offers services in the node's name, and may be seen before the node is: then the node's
  // process counts, and an event reports it.
  if (was_another && was_alive && state.alive == true)
    write_.events.tell(at, ComponentFound{*component, seen.pid});
}

// Its consumers count as depending on it until then.
void Monitor::await_ends(ComponentId component, Time at) {
  write_.components[component].awaits_ends_until = later(at, kEndsAwaited);
  deadlines_.set(knowledge_.rules.inputs.size() + 2 + component.index, later(at, kEndsAwaited));
  keep_ends(component);
  note_ends(component, at);
}

void Monitor::note_ends(ComponentId component, Time at) {
  const ComponentState& state = knowledge_.components[component];
  const bool is_whole = knowledge_.graph.is_present(component);
  if (state.awaits_ends_until != kLongAgo && is_whole && knowledge_.graph.has_all_ends(component))
    await_ends_no_more(component, at);
}

bool Monitor::is_at_its_start(ComponentId component, Time now) const {
  const ComponentState& state = knowledge_.components[component];
  return has_answered_[component.index] && !state.answers_probes && state.in_graph &&
         state.process == ProcessState::kRunning && now < later(state.node_seen, kStartAwaited);
}

void Monitor::await_ends_no_more(ComponentId component, Time at) {
  ComponentState& state = write_.components[component];
  state.awaits_ends_until = kLongAgo;
  state.ends_back = at;
  deadlines_.clear(knowledge_.rules.inputs.size() + 2 + component.index);
  keep_ends(component);
}

void Monitor::keep_ends(ComponentId component) {
  const ComponentState& state = knowledge_.components[component];
  const bool is_wanted = state.intended_lifecycle == Lifecycle::kActive ||
                         state.intended_lifecycle == Lifecycle::kInactive;
  write_.graph.keep_ends(
      component, (is_wanted && !is_up(state.lifecycle)) || state.awaits_ends_until != kLongAgo);
}

void Monitor::on(Time at, const NodeVanished& seen) {
  write_.graph.node_vanished(seen.node);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (!component) return;
  if (knowledge_.graph.has_several_nodes(*component) && knowledge_.graph.has_any_node(*component))
    return note_part_vanished(*component, seen.node, at);
  // A process in Python leaves the graph before it ends. Its exit is not known yet, and by then
  // culprit may have ended it.
  if (knowledge_.states.reservation(*component) == nullptr) note_end_of_start(*component, at);
  note_farewell(*component, at);
  forget_process(*component, at);
  // If there are several, the graph reports next which one it is from now on, perhaps in another
  // step.
  if (knowledge_.components[*component].namesakes > 0) return;
  update_alive(*component, at, "its node left the graph");
}

// The process of the others is still there, as far as is known.
void Monitor::note_part_vanished(ComponentId component, const std::string& node, Time at) {
  ComponentState& state = write_.components[component];
  note_farewell(component, at);
  if (node == knowledge_.graph.node_name(component)) {
    const int pid = state.node_pid;
    forget_process(component, at);
    state.node_pid = pid;
  }
  state.in_graph = false;
  update_alive(component, at, "its node " + node + " left the graph");
}

void Monitor::on(Time, const NamesakesSeen& seen) {
  const auto component = knowledge_.graph.component_of(seen.node);
  if (component) write_.components[*component].namesakes = seen.others;
}

void Monitor::on(Time at, const EndpointAppeared& seen) {
  write_.graph.endpoint_appeared(seen.node, seen.kind, seen.name);
  const auto component = knowledge_.graph.component_of(seen.node);
  if (component) note_ends(*component, at);
  if (seen.kind != EndpointKind::kPublisher) return;
  for (const TopicId topic : topics_of(component, seen.name)) see(topic, at);
}

void Monitor::on(Time, const EndpointVanished& seen) {
  write_.graph.endpoint_vanished(seen.node, seen.kind, seen.name);
}

void Monitor::remember(const History& past) {
  for (const Event& event : past) {
    if (const auto* intended = std::get_if<LifecycleIntended>(&event.what)) {
      ComponentState& state = write_.components[intended->component];
      state.intended_lifecycle = intended->state;
      state.intended_since = event.at;
      state.brought.reset();
      if (intended->is_owed) write_.components.owe_activation(intended->component, event.at);
    }
    if (const auto* came_up = std::get_if<CameUp>(&event.what)) {
      ComponentState& state = write_.components[came_up->component];
      state.coming_up = came_up->how;
      if (came_up->how.driver == ComingUp::Driver::kCulprit) state.culprit_raised = event.at;
    }
    if (const auto* down = std::get_if<StaysDown>(&event.what)) write_.departures.remember(*down);
  }
}

void Monitor::on(Time at, const LifecycleRead& seen) {
  ComponentState& state = write_.components[seen.component];
  const bool is_primary = seen.state != Lifecycle::kUnknown && seen.state != Lifecycle::kTransition;
  note_given_back(seen.component, seen.state, at);
  // A new process comes up from an unknown state, and that is no change.
  if (is_primary && state.lifecycle != Lifecycle::kUnknown && seen.state != state.lifecycle &&
      state.brought)
    state.brought->is_changed |= seen.state != state.brought->to;
  const bool was_inactive =
      state.lifecycle != Lifecycle::kUnknown && state.lifecycle != Lifecycle::kActive;
  if (was_inactive && seen.state == Lifecycle::kActive)
    state.past_trouble = PastTrouble{state.lifecycle_since, at};
  if (seen.state != state.lifecycle) state.lifecycle_since = at;
  state.lifecycle = seen.state;
  if (seen.state != Lifecycle::kUnknown) state.note_trouble(at);
  state.was_active |= seen.state == Lifecycle::kActive;
  if (seen.state != Lifecycle::kTransition) {
    state.changes_until = kNever;
  } else if (state.changes_until == kNever) {
    const bool is_measured = state.coming_up.rising > Duration::zero();
    const bool is_ours = state.transition_patience > Duration::zero();
    const Duration longest =
        std::max(longest_transition(state.coming_up), state.transition_patience);
    state.changes_until = later(at, is_measured || is_ours ? longest : kUnknownTransition);
  }
  if (is_primary) write_.discovered.read_lifecycle(seen.component);
  const bool is_owed = state.is_to_be_given_back() && seen.state == state.brought->to;
  if (is_primary && !is_owed && !state.took_place &&
      knowledge_.states.reservation(seen.component) == nullptr)
    write_.components.intend_lifecycle(seen.component, seen.state, at, write_.events);
  if (seen.state != Lifecycle::kUnknown) state.took_place = false;
  if (seen.is_shut_down && knowledge_.states.reservation(seen.component) == nullptr)
    write_.departures.ended_by_order(seen.component, StaysDown::Why::kShutDown);
  if (is_primary && seen.state != Lifecycle::kFinalized) write_.departures.is_up(seen.component);
  note_rise(seen.component, seen.state, at);
  if (is_up(seen.state) && state.awaits_ends_until != kLongAgo)
    await_ends_no_more(seen.component, at);
  keep_ends(seen.component);
  update_lifecycle_inputs(seen.component, at);
}

// A component that is active again is owed nothing: a person may deactivate it. If it was active all the
// time, the abandoned deactivation may still come, for as long as a transition may take.
void Monitor::note_given_back(ComponentId component, Lifecycle now, Time at) {
  ComponentState& state = write_.components[component];
  if (!state.brought || !state.brought->is_owed) return;
  const bool was_active = state.lifecycle == Lifecycle::kActive;
  const bool is_active = now == Lifecycle::kActive;
  const bool is_activated =
      is_active && !was_active && (state.lifecycle != Lifecycle::kUnknown || state.took_place);
  const bool stays_active =
      (was_active || is_active) && at >= later(state.brought->since, kUnknownTransition);
  if (!is_activated && !stays_active) return;
  state.brought.reset();
  write_.events.tell(at, LifecycleIntended{component, state.intended_lifecycle});
}

// During a transition it is in no state, and that is unknown until the transition takes too long.
void Monitor::update_lifecycle_inputs(ComponentId component, Time now) {
  const Lifecycle state = knowledge_.components[component].lifecycle;
  const bool is_unknown = state == Lifecycle::kUnknown ||
                          (state == Lifecycle::kTransition && !hangs_in_transition(component, now));
  for (const InputId id : component_inputs_[component.index]) {
    if (knowledge_.rules[id].kind == Kind::kLifecycle)
      write_.signals.set(id, is_unknown ? Slot() : Slot::of(to_string(state)));
  }
  update_groups_of(component, now);
}

void Monitor::update_groups_of(ComponentId component, Time now) {
  for (std::size_t g = 0; g < knowledge_.rules.groups.size(); ++g) {
    const auto& members = knowledge_.rules.groups[g].members;
    if (std::ranges::find(members, component) != members.end()) update_group(GroupId(g), now);
  }
}

// A manager that stops half-way leaves no group inactive as a whole: one server is down, or still active.
void Monitor::note_pause(const Group& group, Time now) {
  const bool is_up = std::ranges::any_of(group.members, [&](ComponentId member) {
    return knowledge_.components[member].lifecycle == Lifecycle::kActive;
  });
  if (!is_up && health_of(group, knowledge_.components, now) != GroupHealth::kInactive) return;
  for (const ComponentId member : group.members) write_.components[member].is_paused = !is_up;
}

void Monitor::update_group(GroupId id, Time now) {
  const Group& group = knowledge_.rules[id];
  note_pause(group, now);
  const GroupHealth health = health_of(group, knowledge_.components, now);
  const bool is_known = health != GroupHealth::kUnknown;
  if (is_known) write_.discovered.read(group.health);
  for (const InputId input : signals_[group.health.index].inputs) {
    if (knowledge_.rules[input].kind != Kind::kSignal) continue;
    write_.signals.set(input, is_known ? Slot::of(to_string(health)) : Slot());
    if (is_known) write_.signals.set_read_at(input, now);
  }
  deadlines_.set(look_at_expected_slot() + 1 + id.index,
                 settles_at(group, knowledge_.components, now));
}

// A driver other than culprit brought it up: itself, its launcher, a lifecycle manager.
void Monitor::note_rise(ComponentId component, Lifecycle now, Time at) {
  ComponentState& state = write_.components[component];
  if (now == Lifecycle::kUnconfigured) state.is_rising = true;
  if (now != Lifecycle::kActive || !std::exchange(state.is_rising, false)) return;
  const bool is_start = state.in_graph && at <= later(state.node_seen, kStart);
  if (!is_start || knowledge_.states.reservation(component) != nullptr) return;
  ComingUp how = state.coming_up;
  how.driver = ComingUp::Driver::kOther;
  how.rising = at - state.node_seen;
  write_.components.note_coming_up(component, how, at, write_.events);
}

// A node that activates itself and was activated before may end because of that. It is left more
// time the next time: as long as it lived.
void Monitor::note_end_of_start(ComponentId component, Time at) {
  const ComponentState& state = knowledge_.components[component];
  // A start before culprit watched (`run --launch`, an earlier culprit) is seen only afterwards.
  const Time began = std::min(state.node_seen, state.culprit_raised);
  if (!state.in_graph || began == kLongAgo || at > later(began, kStart)) return;
  ComingUp how = state.coming_up;
  how.driver = ComingUp::Driver::kOther;
  how.rising = at - began;
  write_.components.note_coming_up(component, how, at, write_.events);
  const Component& declared = knowledge_.rules[component];
  if (declared.lifecycle == LifecycleDriver::kManaged && state.culprit_raised != kLongAgo)
    write_.events.tell(
        at, Trouble{declared.name + " ended soon after culprit had activated it, as LIFECYCLE "
                                    "managed says; does it activate itself? Then it is LIFECYCLE "
                                    "self"});
}

void Monitor::on(Time at, const ProcessSeen& seen) {
  ComponentState& state = write_.components[seen.component];
  // systemd's report on its unit is proof, also if its node was never seen.
  if (knowledge_.rules[seen.component].has_owner()) see(seen.component, at);
  // A report about a process that the node no longer runs in is no evidence about the node.
  const int present = state.node_pid != 0 ? state.node_pid : state.pid;
  // A component that its owner could not even start has no process.
  const bool is_other =
      seen.pid != present && (seen.pid != 0 || knowledge_.rules[seen.component].has_owner());
  if (is_other && state.in_graph && seen.state != ProcessState::kRunning) return;
  if (seen.state == ProcessState::kRunning && seen.pid != state.pid) note_begin(seen, at);
  set_process(state, seen.state, at);
  state.note_trouble(at);
  state.pid = seen.pid;
  state.process_remark = seen.remark;
  // One of several was too many: the graph says which it is from now on, so none is missed.
  if (seen.state == ProcessState::kGone && state.in_graph && state.namesakes > 0) return;
  note_process(seen, at);
  if (seen.state == ProcessState::kGone) {
    if (has_crashed(seen.remark)) note_end_of_start(seen.component, at);
    write_.graph.component_vanished(seen.component);
    forget_process(seen.component, at);
  }
  update_alive(seen.component, at,
               seen.state != ProcessState::kStopped ? seen.remark
               : seen.cause == Cause::kOrder        ? "its process is frozen"
                                                    : "its process is stopped");
}

void Monitor::on(Time at, const Probed& seen) {
  if (is_deaf_ && !seen.answered) return;
  if (seen.node > 0) return note_part_probed(seen, at);
  ComponentState& state = write_.components[seen.component];
  if (state.missed_probes == kMissedProbes - 1) state.missed_since = at;
  state.missed_probes = seen.answered ? 0 : state.missed_probes + 1;
  state.answers_probes |= seen.answered;
  if (seen.answered) {
    has_answered_[seen.component.index] = true;
    state.answered = at;
    state.questioned.unanswered.reset();
    state.questioned.is_pointless = false;
  }
  const bool is_changing = hangs_in_transition(seen.component, at);
  if (is_changing) update_lifecycle_inputs(seen.component, at);
  update_alive(seen.component, at,
               is_changing ? "a transition of its lifecycle hangs, and it does not answer"
               : state.known_pid() == 0 ? "it does not answer"
                                        : "its process runs, but it does not answer and is silent");
}

// Another node of its process. A node without an executor of its own answers only now and then, or
// never: only one that has answered from the beginning can cease to.
void Monitor::note_part_probed(const Probed& seen, Time at) {
  std::vector<PartMisses>& parts = part_misses_[seen.component.index];
  parts.resize(std::max<std::size_t>(parts.size(), seen.node));
  PartMisses& part = parts[seen.node - 1u];
  part.has_answered |= seen.answered;
  part.is_reliable &= part.has_answered;
  part.count = seen.answered || !part.is_reliable ? 0 : part.count + 1;
  const auto& nodes = knowledge_.rules[seen.component].other_nodes;
  const std::string name = seen.node <= nodes.size() ? nodes[seen.node - 1u] : "";
  update_alive(seen.component, at, "its process runs, but its node " + name + " does not answer");
}

// It began, and not all of its nodes have come.
void Monitor::note_missing_part(ComponentId component, Time at) {
  const DependencyGraph& graph = knowledge_.graph;
  if (graph.has_several_nodes(component) && graph.has_any_node(component) &&
      !graph.is_present(component))
    update_alive(component, at, "its node " + graph.missing_node(component) + " is not there");
}

bool Monitor::has_hung_part(ComponentId component) const {
  return std::ranges::any_of(part_misses_[component.index],
                             [](const PartMisses& part) { return part.count >= kMissedAlone; });
}

void Monitor::on(Time at, const ProcessWorked& seen) {
  ComponentState& state = write_.components[seen.component];
  if (seen.pid == state.pid && state.process == ProcessState::kRunning) state.worked = at;
}

void Monitor::on(Time, const UsageSeen& seen) {
  if (knowledge_.components[seen.component].process != ProcessState::kRunning) return;
  for (const InputId id : component_inputs_[seen.component.index]) {
    const Kind kind = knowledge_.rules[id].kind;
    if (kind == Kind::kCpu) write_.signals.set(id, Slot::of(seen.cores));
    if (kind == Kind::kMemory) write_.signals.set(id, Slot::of(seen.mib));
  }
}

// The usage of a process does not hold for the one that follows it.
void Monitor::forget_usage(ComponentId component) {
  for (const InputId id : component_inputs_[component.index]) {
    const Kind kind = knowledge_.rules[id].kind;
    if (kind == Kind::kCpu || kind == Kind::kMemory) write_.signals.forget(id);
  }
}

// The first sign of a component: from now on it is known how often it logged.
void Monitor::see(ComponentId component, Time at) {
  if (!write_.discovered.note(component, at)) return;
  for (const InputId id : component_inputs_[component.index]) {
    if (knowledge_.rules[id].kind == Kind::kLogs) deadlines_.set(id.index, at);
  }
}

void Monitor::on(Time at, const StartBarred& seen) {
  ComponentState& state = write_.components[seen.component];
  if (state.start_missing == seen.missing) return;
  state.start_missing = seen.missing;
  const std::string& name = knowledge_.rules[seen.component].name;
  write_.events.tell(
      at, Trouble{seen.missing.empty()
                      ? name + " can be started again: nothing that its start needs is missing"
                      : name + " cannot be started: " + seen.missing +
                            "; culprit starts it when that is there"});
}

// Reachability of another computer does not hold for this one.
void Monitor::on(Time, const LivesOn& seen) {
  if (knowledge_.components[seen.component].host == seen.host) return;
  write_.components[seen.component].host = seen.host;
  write_.components.set_host_silent(seen.component, {});
  deadlines_.clear(return_of(seen.component));
}

void Monitor::on(Time, const EndsWith& seen) {
  write_.components[seen.component].ends_with = seen.others;
}

// The node or its process exited or is another now: the knowledge about it is void.
void Monitor::forget_process(ComponentId component, Time at) {
  ComponentState& state = write_.components[component];
  if (state.in_graph) expect_no_more();
  forget_what_was_heard_of(component, at);
  forget_usage(component);
  state.in_graph = false;
  state.node_pid = 0;
  state.is_rising = false;
  if (state.node_seen != kLongAgo) state.culprit_raised = kLongAgo;
  state.answers_probes = false;
  state.questioned = {};
  state.transition_patience = {};
  if (state.lifecycle != Lifecycle::kUnknown) state.took_place = true;
  if (state.brought && state.brought->is_changed) state.brought.reset();
  on(at, LifecycleRead{component, Lifecycle::kUnknown});
  for (std::size_t p = 0; p < knowledge_.rules.parameters.size(); ++p) {
    if (knowledge_.rules.parameters[p].component != component) continue;
    write_.components[ParameterId(p)].reset();
    for (const InputId id : parameter_inputs_[p]) write_.signals.forget(id);
  }
}

bool Monitor::hangs_in_transition(ComponentId component, Time now) const {
  return knowledge_.components[component].changes_until <= now;
}

// A node may have one thread, which answers nothing while it changes its lifecycle. While its topics
// are received, or pause as they did when it was well, it is at work. If its process is known to run,
// it can only be found to hang if it answered before.
bool Monitor::does_not_answer(ComponentId component, Time now) const {
  const ComponentState& state = knowledge_.components[component];
  if (state.missed_probes < kMissedProbes) return false;
  if (now < later(awake_, kUnsure) && !knowledge_.is_unheard(component)) return false;
  if (state.lifecycle != Lifecycle::kUnknown && now < later(state.lifecycle_since, kSettles) &&
      !hangs_in_transition(component, now))
    return false;
  if (state.changes_until != kNever && !hangs_in_transition(component, now)) return false;
  if (state.known_pid() == 0)
    return !is_heard_of(component, knowledge_) || is_silent(component, now);
  if (!state.answers_probes) return false;
  if (state.changes_until != kNever) return true;
  return is_heard_of(component, knowledge_) ? is_silent(component, now)
                                            : state.missed_probes >= kMissedAlone;
}

bool Monitor::is_silent(ComponentId component, Time now) const {
  constexpr Duration kLeast = std::chrono::seconds(1);
  for (std::size_t t = 0; t < knowledge_.rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = knowledge_.signals.rhythm(TopicId(t));
    const culprit::Topic& topic = knowledge_.rules.topics[t];
    if (!rhythm.last || rhythm.longest <= Duration::zero() ||
        !knowledge_.graph.publishes(component, topic) ||
        knowledge_.graph.publisher_count(topic) != 1)
      continue;
    const Duration pause = std::max(kLeast, rhythm.longest + rhythm.longest / 2);
    const Duration there = now - knowledge_.components[component].node_seen;
    if (std::min(silence_of(TopicId(t), now), there) < pause) return false;
  }
  return true;
}

void Monitor::update_alive(ComponentId component, Time at, const std::string& remark) {
  ComponentState& state = write_.components[component];
  const bool is_part_hung = has_hung_part(component) && at >= later(awake_, kUnsure);
  const bool answers = !does_not_answer(component, at) && !is_part_hung;
  const bool is_there = state.in_graph && state.process == ProcessState::kRunning;
  const bool is_alive = is_there && answers;
  if (!knowledge_.discovered.has(component)) return;          // it may be a wrong name
  if (!is_alive && !state.alive && at < discovered_) return;  // it may still be discovered
  const bool may_be_unheard = is_deaf_ || at < graced_ || state.is_out_of_reach;
  if (!is_alive && may_be_unheard && state.process == ProcessState::kRunning) {
    state.alive.reset();
    return update_alive_inputs(component, at, Slot());
  }
  // Its process or its lifecycle may be another one meanwhile.
  if (state.alive == is_alive) return state.note_trouble(at);
  const bool is_ended = !is_there && is_being_ended(component);
  state.alive = is_alive;
  state.alive_since = at;
  if (is_alive && state.host_silent) deadlines_.set(return_of(component), later(at, kSpeaks));
  if (is_alive) {
    write_.events.tell(at, ComponentFound{component, state.node_pid});
  } else {
    const bool is_host = knowledge_.is_unheard(component);
    write_.events.tell(at,
                       ComponentLost{component, is_host ? "it " + knowledge_.why_unheard(component)
                                                : is_ended ? "culprit ended it"
                                                           : remark});
  }
  update_alive_inputs(component, at, Slot::of(is_alive));
}

void Monitor::update_alive_inputs(ComponentId component, Time now, const Slot& value) {
  write_.components[component].note_trouble(now);
  for (const InputId id : component_inputs_[component.index]) {
    if (knowledge_.rules[id].kind == Kind::kAlive) write_.signals.set(id, value);
  }
  update_groups_of(component, now);
}

}  // namespace culprit
