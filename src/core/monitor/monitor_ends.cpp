// The monitor's part about how processes end: whether that is known to be a fault, so that what the
// component published is known to be silent, or somebody's wish.
#include <algorithm>

#include "monitor/monitor.h"

namespace culprit {
namespace {

// Can the attempt end a process? One that only reconfigures, or goes through the lifecycle, cannot.
bool may_end(const Attempt& attempt, const RuleSet& rules) {
  return std::ranges::any_of(rules[attempt.strategy].adaptations, [](const Adaptation& each) {
    return each.type == AdaptationType::kRedeploy || each.type == AdaptationType::kStop ||
           each.type == AdaptationType::kStart;
  });
}

// Is there an attempt under way that can end its process, and for which `is_meant` is true?
template <class IsMeant>
bool may_be_ended(ComponentId component, const Knowledge& knowledge, IsMeant is_meant) {
  bool is_any = false;
  knowledge.states.for_each_reservation(component, [&](const Attempt& each) {
    is_any = is_any || (may_end(each, knowledge.rules) && is_meant(each));
  });
  return is_any;
}

bool is_adapting(const Attempt& attempt) { return attempt.stage == Attempt::Stage::kAdapting; }

// Does culprit end it? A strategy begins it anew, or reloads a component of its container: if the
// container does not answer, it is replaced with all that it has.
bool is_ended_here(ComponentId component, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  if (may_be_ended(component, knowledge, [](const Attempt&) { return true; })) return true;
  const ComponentId home = container_of(component, rules).value_or(component);
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (container_of(ComponentId(c), rules) != home) continue;
    if (may_be_ended(ComponentId(c), knowledge, is_adapting)) return true;
  }
  return false;
}

}  // namespace

void Monitor::on(Time at, const LauncherSeen& seen) {
  if (seen.has_ended) return write_.departures.launcher_ended(seen, at);
  write_.departures.launched(seen.component, seen.pid);
}

// Does a strategy under way end the process that was there before it?
bool Monitor::is_being_ended(ComponentId component) const {
  const Time alive_since = knowledge_.components[component].alive_since;
  return may_be_ended(component, knowledge_, [&](const Attempt& attempt) {
    return is_adapting(attempt) && attempt.first_change != kNever &&
           alive_since <= attempt.first_change;
  });
}

void Monitor::on(Time at, const StartedHere& seen) { write_.departures.started_here(seen, at); }

void Monitor::on(Time, const Unloaded& seen) {
  if (knowledge_.components[seen.component].in_graph) return;  // it was loaded again meanwhile
  if (is_ended_here(seen.component, knowledge_)) return;
  write_.departures.ended_by_order(seen.component, StaysDown::Why::kUnloaded);
}

// Whether a person ended it is known once its launcher has ended, too.
void Monitor::settle_departures(Time now) {
  Departures::Settled settled = write_.departures.settle(now);
  for (StaysDown& down : settled.down) write_.events.tell(now, std::move(down));
  for (const int launcher : settled.broken)
    write_.events.tell(now,
                       Trouble{"process " + std::to_string(launcher) +
                               " ended all that it had started when one component of it ended. "
                               "If its launch file says on_exit=Shutdown(), leave that out for "
                               "what culprit redeploys"});
}

// Before what was known of its node is forgotten.
void Monitor::note_process(const ProcessSeen& seen, Time at) {
  switch (seen.state) {
    case ProcessState::kRunning:
      write_.departures.goes_on(seen.component, at);
      return note_no_longer_dead(seen.component);
    case ProcessState::kStopped:
      if (seen.cause == Cause::kWish)
        write_.departures.ended_by_order(seen.component, StaysDown::Why::kStopped);
      if (seen.cause == Cause::kOrder)
        write_.departures.ended_by_order(seen.component, StaysDown::Why::kFrozen);
      if (seen.cause == Cause::kFault && knowledge_.components[seen.component].in_graph)
        note_known_dead(seen.component, at);
      return;
    case ProcessState::kGone:
      return note_end(seen, at);
  }
}

void Monitor::note_begin(const ProcessSeen& seen, Time at) {
  using By = Departures::By;
  const bool is_ours = is_ended_here(seen.component, knowledge_);
  write_.departures.arrived(seen.component, seen.pid, at, is_ours ? By::kCulprit : By::kOther);
}

void Monitor::note_end(const ProcessSeen& seen, Time at) {
  const ComponentId component = seen.component;
  const bool has_said_good_bye = !knowledge_.components[component].in_graph;
  note_no_longer_dead(component);
  if (seen.cause == Cause::kOrder) {  // also if culprit was about to end it
    write_.departures.left(component, at);
    const bool has_owner = knowledge_.rules[component].has_owner();
    write_.departures.ended_by_order(
        component, has_owner ? StaysDown::Why::kOwner : StaysDown::Why::kTerminal);
  } else if (is_ended_here(component, knowledge_)) {
    write_.departures.ended_here(component, at);
  } else if (seen.cause == Cause::kDoubt) {
    write_.departures.failed(component, at);
  } else if (has_said_good_bye) {
    write_.departures.lost(component);
  } else if (seen.cause == Cause::kWish) {
    write_.departures.left(component, at);
  } else if (seen.cause == Cause::kFault) {
    write_.departures.fell(component, at);
  } else {
    write_.departures.lost(component);
  }
  const bool is_broken = seen.cause == Cause::kFault || seen.cause == Cause::kDoubt;
  if (!has_said_good_bye && is_broken) deadlines_.set(farewell_of(component), later(at, kFarewell));
}

// Handles a node that leaves the graph while its process runs, or the moment after it ended.
void Monitor::note_farewell(ComponentId component, Time at) {
  const bool is_running = knowledge_.components[component].process == ProcessState::kRunning &&
                          knowledge_.components[component].in_graph;
  const bool is_fallen = deadlines_.at(farewell_of(component)) != kNever;
  deadlines_.clear(farewell_of(component));
  if (!is_running && !is_fallen) return;  // its lease ran out, long after its end
  if (!is_ended_here(component, knowledge_)) write_.departures.left(component, at);
}

void Monitor::note_known_dead(ComponentId component, Time at) {
  write_.components.set_known_dead(component, at);
  touch_topics_of(component);
}

void Monitor::note_no_longer_dead(ComponentId component) {
  deadlines_.clear(farewell_of(component));
  if (!knowledge_.components[component].known_dead) return;
  write_.components.set_known_dead(component, std::nullopt);
  touch_topics_of(component);
}

// The rules that read whether they come have to be looked at.
void Monitor::touch_topics_of(ComponentId component) {
  for (const KnownRobot::End& end : knowledge_.graph.ends_of(component)) {
    if (end.kind != EndpointKind::kPublisher) continue;
    for (const TopicId topic : topics_of(component, end.name)) {
      topics_[topic.index].is_known_silent = true;
      for (const InputId id : topics_[topic.index].inputs) write_.signals.touch(id);
    }
  }
}

}  // namespace culprit
