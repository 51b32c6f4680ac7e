#include "rule_test/scripted_robot.h"

#include <algorithm>

#include "language/evaluate.h"

namespace culprit::rule_test {
namespace {

Value empty_value(Type type) {
  switch (type) {
    case Type::kBool:
      return false;
    case Type::kInt:
      return std::int64_t{0};
    case Type::kString:
      return std::string();
    case Type::kDouble:
    case Type::kDuration:
      break;
  }
  return 0.0;
}

// The adaptation can make the manager ask this of its component.
bool can_ask(const Adaptation& adaptation, const Command& command) {
  using enum AdaptationType;
  const AdaptationType type = adaptation.type;
  if (const auto* set = std::get_if<SetParameter>(&command.what))
    return adaptation.subject == set->name &&
           (type == kSetParameter || type == kIncreaseParameter || type == kDecreaseParameter ||
            type == kChangeCommunication);
  if (const auto* change = std::get_if<ChangeLifecycle>(&command.what))
    return (type == kActivate && change->transition != Transition::kDeactivate) ||
           (type == kDeactivate && change->transition != Transition::kActivate) || type == kRestart;
  if (std::holds_alternative<StopProcess>(command.what)) return type == kRedeploy || type == kStop;
  if (std::holds_alternative<StartProcess>(command.what))
    return type == kRedeploy || type == kStart;
  if (std::holds_alternative<CallService>(command.what)) return type == kCall;
  if (const auto* mode = std::get_if<ChangeMode>(&command.what))
    return type == kChangeMode && adaptation.subject == mode->mode;
  return false;  // reading is no change
}

// A restart takes its time to come back, not to go.
bool takes_time(const Command& command, const Adaptation& adaptation) {
  if (std::holds_alternative<StopProcess>(command.what))
    return adaptation.type == AdaptationType::kStop;
  const auto* change = std::get_if<ChangeLifecycle>(&command.what);
  return change == nullptr || change->transition != Transition::kDeactivate ||
         adaptation.type != AdaptationType::kRestart;
}

}  // namespace

ScriptedRobot::ScriptedRobot(const RuleSet& rules, const Scenario& scenario)
    : rules_(rules), scenario_(scenario) {
  build_components(scenario);
  build_voices(scenario);
  set_default_parameters();
  for (const GoalCourse& goal : scenario.goals) {
    plan(Time{goal.from}, [this, topic = goal.topic] { tell_goals(topic); });
    if (goal.until) plan(Time{*goal.until}, [this, topic = goal.topic] { tell_goals(topic); });
  }
  for (const LogCourse& log : scenario.logs) plan(Time{log.from}, [this, &log] { write_log(log); });
  for (const Incident& i : scenario.incidents) plan(Time{i.at}, [this, &i] { incident(i); });
}

void ScriptedRobot::build_components(const Scenario& scenario) {
  for (const culprit::Component& known : rules_.components) {
    Component component;
    component.node = known.node.empty() ? "/" + known.name : known.node;
    component.pid = ++last_pid_;
    components_.push_back(std::move(component));
  }
  for (const InitialState& state : scenario.states) {
    Component& component = components_[state.component.index];
    component.is_in_graph = state.presence == Presence::kThere;
    component.process = component.is_in_graph ? ProcessState::kRunning : ProcessState::kGone;
    component.state = component.state_at_start = state.lifecycle;
  }
  for (const Endpoint& endpoint : scenario.endpoints)
    components_[endpoint.component.index].endpoints.emplace_back(endpoint.kind, endpoint.name);
  for (const Need& need : scenario.needs) {
    Component& producer = components_[need.producer.index];
    Component& consumer = components_[need.consumer.index];
    consumer.needs.push_back(need.producer);
    const std::string service = producer.node + "/needed";
    producer.endpoints.emplace_back(EndpointKind::kServer, service);
    consumer.endpoints.emplace_back(EndpointKind::kClient, service);
  }
  for (std::size_t c = 0; c < components_.size(); ++c) appear(ComponentId(c));
}

// Courses of one subject, in the file's shared part and in the test, make one voice.
void ScriptedRobot::build_voices(const Scenario& scenario) {
  for (const Course& course : scenario.courses) {
    for (const Stretch& stretch : course.stretches) {
      if (const auto* id = std::get_if<ParameterId>(&course.subject)) {
        plan(Time{stretch.from},
             [this, id = *id, &stretch] { follow_parameter(id, *stretch.value); });
        continue;
      }
      plan(Time{stretch.from}, [this] { has_changed_ = true; });
      if (stretch.until) plan(Time{*stretch.until}, [this] { has_changed_ = true; });
    }
    if (std::holds_alternative<ParameterId>(course.subject)) continue;
    auto voice = std::find_if(voices_.begin(), voices_.end(),
                              [&](const Voice& v) { return v.subject == course.subject; });
    if (voice == voices_.end()) {
      voices_.push_back({course.subject, {}, kPeriod, {}, {}, false, {}});
      voice = voices_.end() - 1;
    }
    voice->stretches.insert(voice->stretches.end(), course.stretches.begin(),
                            course.stretches.end());
    voice->period = course.period.value_or(voice->period);
  }
  for (const Origin& origin : scenario.origins) {
    for (Voice& voice : voices_) {
      if (voice.subject == origin.subject) voice.tellers.push_back(origin.component);
    }
  }
}

void ScriptedRobot::set_default_parameters() {
  for (const Strategy& strategy : rules_.strategies) {
    for (const Adaptation& adaptation : strategy.adaptations) {
      Component& component = components_[adaptation.component.index];
      const bool is_topic = adaptation.type == AdaptationType::kChangeCommunication;
      if (is_topic || !adaptation.value.empty())
        component.parameters.emplace(adaptation.subject, is_topic
                                                             ? Value(std::string())
                                                             : empty_value(adaptation.value.type));
    }
  }
}

KnownRobot ScriptedRobot::declared() const {
  const auto is_absent = [this](ComponentId id) { return !components_[id.index].is_in_graph; };
  KnownRobot known;
  for (std::size_t c = 0; c < rules_.components.size(); ++c) {
    if (!is_absent(ComponentId(c)))
      known.parts.push_back({rules_.components[c].name, components_[c].node, {}});
  }
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    const Topic& topic = rules_.topics[t];
    const std::pair publisher(EndpointKind::kPublisher, topic.name);
    bool has_publisher = false;
    bool is_there = false;
    for (std::size_t c = 0; c < components_.size(); ++c) {
      const auto& ends = components_[c].endpoints;
      const bool is_meant = !topic.publisher || *topic.publisher == ComponentId(c);
      if (!is_meant || std::ranges::find(ends, publisher) == ends.end()) continue;
      has_publisher = true;
      is_there |= components_[c].is_in_graph;
    }
    if (is_there || !has_publisher) known.topics.push_back(rules_.label(TopicId(t)));
  }
  return known;
}

// ---- time

void ScriptedRobot::observe(Time until, std::vector<Observation>& observations) {
  while (true) {
    Time next = until;
    if (!agenda_.empty()) next = std::min(next, agenda_.begin()->first);
    for (const Voice& voice : voices_) {
      if (voice.is_heard || has_changed_) next = std::min(next, voice.next);
    }
    now_ = std::max(now_, next);
    while (!agenda_.empty() && agenda_.begin()->first <= now_) {
      const auto action = std::move(agenda_.begin()->second);
      agenda_.erase(agenda_.begin());
      action();
    }
    if (has_changed_) refresh_voices();
    for (Voice& voice : voices_) {
      if (voice.is_heard && voice.next <= now_) speak(voice);
    }
    if (!inbox_.empty() || now_ >= until) break;
  }
  std::move(inbox_.begin(), inbox_.end(), std::back_inserter(observations));
  inbox_.clear();
}

void ScriptedRobot::speak(Voice& voice) {
  voice.next = later(voice.next, voice.period);
  if (const auto* topic = std::get_if<TopicId>(&voice.subject)) {
    tell(SampleArrived{*topic, 1});
    // A trigger that reads the whole topic counts it, too.
    for (std::size_t t = 0; rules_[*topic].publisher && t < rules_.topics.size(); ++t) {
      if (rules_.topics[t].name == rules_[*topic].name && !rules_.topics[t].publisher)
        tell(SampleArrived{TopicId(t), 1});
    }
  } else if (const auto* signal = std::get_if<SignalId>(&voice.subject)) {
    tell(SignalRead{*signal, *voice.value});
  } else if (const auto* diagnostic = std::get_if<DiagnosticId>(&voice.subject)) {
    tell(DiagnosticRead{*diagnostic,
                        static_cast<std::uint8_t>(std::get<std::int64_t>(*voice.value))});
  }
}

// Updates the value of each voice, and whether it is published. A voice that starts is published at
// once.
void ScriptedRobot::refresh_voices() {
  has_changed_ = false;
  for (Voice& voice : voices_) {
    const auto covers = [&](const Stretch& s) {
      return Time{s.from} <= now_ && (!s.until || now_ < Time{*s.until});
    };
    const auto last = std::find_if(voice.stretches.rbegin(), voice.stretches.rend(), covers);
    voice.value = last == voice.stretches.rend() ? std::nullopt : last->value;
    if (voice.value && std::holds_alternative<TopicId>(voice.subject))
      voice.period = from_seconds(1 / std::get<double>(*voice.value));
  }
  const std::vector<bool> works = working();
  for (Voice& voice : voices_) {
    const bool was_heard = voice.is_heard;
    voice.is_heard = voice.value && std::all_of(voice.tellers.begin(), voice.tellers.end(),
                                                [&](ComponentId c) { return works[c.index]; });
    if (voice.is_heard && !was_heard) voice.next = now_;
  }
}

// From components that cannot work by themselves, spread to all that need them.
std::vector<bool> ScriptedRobot::working() const {
  std::vector<bool> works;
  for (const Component& c : components_) {
    const bool is_active = c.state == Lifecycle::kActive || c.state == Lifecycle::kUnknown;
    works.push_back(c.can_answer() && is_active);
  }
  std::vector<bool> is_mute(components_.size());
  for (const Voice& voice : voices_) {
    for (const ComponentId teller : voice.tellers) {
      if (!voice.value) is_mute[teller.index] = true;
    }
  }
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (std::size_t c = 0; c < components_.size(); ++c) {
      if (!works[c]) continue;
      const auto& needs = components_[c].needs;
      works[c] = std::all_of(needs.begin(), needs.end(),
                             [&](ComponentId n) { return works[n.index] && !is_mute[n.index]; });
      goes_on |= !works[c];
    }
  }
  return works;
}

// ---- what happens to it

void ScriptedRobot::appear(ComponentId id) {
  const Component& component = components_[id.index];
  if (!component.is_in_graph) return;
  tell(ProcessSeen{id, ProcessState::kRunning, component.pid, ""});
  tell(NodeAppeared{component.node, component.pid});
  for (const std::string& other : rules_[id].other_nodes) tell(NodeAppeared{other, component.pid});
  for (const auto& [kind, name] : component.endpoints)
    tell(EndpointAppeared{component.node, kind, name});
  if (component.state != Lifecycle::kUnknown) tell(LifecycleRead{id, component.state});
}

void ScriptedRobot::incident(const Incident& incident) {
  Component& component = components_[incident.component.index];
  has_changed_ = true;
  if (component.process == ProcessState::kGone) return;
  switch (incident.kind) {
    case Incident::Kind::kKilled:
      kill(incident.component);
      for (std::size_t c = 0; c < components_.size(); ++c) {
        if (container_of(ComponentId(c), rules_) == incident.component) kill(ComponentId(c));
      }
      break;
    case Incident::Kind::kStopped:
      component.process = ProcessState::kStopped;
      tell(ProcessSeen{incident.component, ProcessState::kStopped, component.pid, "",
                       Cause::kFault});
      break;
    case Incident::Kind::kHung:
      component.answers = false;
      tell(Probed{incident.component, true});  // until now it answered
      probe(incident.component, component.pid);
      break;
    case Incident::Kind::kState:
      component.state = incident.lifecycle;
      tell(LifecycleRead{incident.component, component.state});
      break;
  }
}

void ScriptedRobot::kill(ComponentId id) {
  Component& component = components_[id.index];
  if (!component.end()) return;
  component.is_in_graph = false;
  tell(ProcessSeen{id, ProcessState::kGone, component.pid, "killed by signal 9", Cause::kFault});
}

// One that hangs is asked whether it is there, until its process is another.
void ScriptedRobot::probe(ComponentId id, int pid) {
  plan(later(now_, kProbePeriod), [this, id, pid] {
    const Component& component = components_[id.index];
    if (component.pid != pid || component.process == ProcessState::kGone) return;
    tell(Probed{id, false});
    probe(id, pid);
  });
}

// All goals of the action that have begun.
void ScriptedRobot::tell_goals(TopicId topic) {
  GoalsSeen seen{topic, {}};
  for (std::size_t i = 0; i < scenario_.goals.size(); ++i) {
    const GoalCourse& goal = scenario_.goals[i];
    if (goal.topic != topic || now_ < Time{goal.from}) continue;
    const bool has_ended = goal.until && Time{*goal.until} <= now_;
    seen.goals.push_back({i, has_ended ? goal.outcome : GoalStatus::kExecuting});
  }
  tell(std::move(seen));
}

void ScriptedRobot::write_log(const LogCourse& log) {
  if (components_[log.component.index].process == ProcessState::kRunning)
    tell(LogSeen{log.component, log.level});
  const Time next = later(now_, kLogPeriod);
  if (log.until && next < Time{*log.until}) plan(next, [this, &log] { write_log(log); });
}

// A topic without a FROM is that of all its publishers.
void ScriptedRobot::heal(const std::vector<Subject>& subjects) {
  has_changed_ = true;
  const auto is_meant = [&](const Subject& healed, const Subject& subject) {
    const auto* whole = std::get_if<TopicId>(&healed);
    const auto* topic = std::get_if<TopicId>(&subject);
    const bool is_of_whole = whole != nullptr && topic != nullptr && !rules_[*whole].publisher &&
                             rules_[*whole].name == rules_[*topic].name;
    return healed == subject || is_of_whole;
  };
  for (Voice& voice : voices_) {
    if (std::ranges::none_of(
            subjects, [&](const Subject& healed) { return is_meant(healed, voice.subject); }))
      continue;
    std::erase_if(voice.stretches, [&](const Stretch& s) {
      return s.from > Duration::zero() && Time{s.from} <= now_;
    });
  }
}

void ScriptedRobot::follow_parameter(ParameterId id, const Value& value) {
  const Parameter& parameter = rules_[id];
  components_[parameter.component.index].parameters[parameter.name] = value;
  tell(ParameterRead{id, value});
}

void ScriptedRobot::hear(const Event& event) {
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    for (const ComponentId component : rules_[chosen->strategy].components)
      components_[component.index].adapted_by = chosen->strategy;
  } else if (const auto* done = std::get_if<AdaptationDone>(&event.what)) {
    const std::size_t last = rules_[done->strategy].adaptations.size() - 1;
    for (const Cure& cure : scenario_.cures) {
      if (cure.strategy != done->strategy || cure.adaptation.value_or(last) != done->adaptation)
        continue;
      plan(later(event.at, cure.after), [this, &cure] { heal(cure.subjects); });
    }
  }
}

// ---- what it is asked

ScriptedRobot::Conduct ScriptedRobot::conduct(const Command& command) const {
  Conduct conduct;
  const auto strategy = components_[command.component.index].adapted_by;
  if (!strategy) return conduct;
  const auto& adaptations = rules_[*strategy].adaptations;
  const auto asking = std::find_if(adaptations.begin(), adaptations.end(), [&](const auto& a) {
    return a.component == command.component && can_ask(a, command);
  });
  if (asking == adaptations.end()) return conduct;
  const auto index = static_cast<std::size_t>(asking - adaptations.begin());
  for (const Answer& answer : scenario_.answers) {
    if (answer.strategy != *strategy || answer.adaptation != index) continue;
    if (answer.manner) conduct.manner = *answer.manner;
    if (answer.takes && takes_time(command, *asking)) conduct.takes = answer.takes;
  }
  return conduct;
}

// A moment later, so that the robot has heard by then which strategy the command serves.
void ScriptedRobot::execute(const Command& command) {
  plan(later(now_, kAnswerTime), [this, command] { serve(command); });
}

void ScriptedRobot::reply(const Command& command, Outcome outcome, decltype(Reply::value) value,
                          std::string text) {
  tell(Reply{command.id, outcome, std::move(value), std::move(text)});
}

void ScriptedRobot::time_out(const Command& command) {
  plan(later(now_, command.timeout), [this, command] { reply(command, Outcome::kTimedOut); });
}

void ScriptedRobot::serve(const Command& command) {
  Component& c = components_[command.component.index];
  const Conduct how = conduct(command);
  if (how.manner == Answer::Manner::kRefuses) return reply(command, Outcome::kRefused);
  if (how.manner == Answer::Manner::kNeverAnswers) return time_out(command);
  if (std::holds_alternative<StartProcess>(command.what))
    return start(command, how.takes.value_or(kStartTime));
  const bool stops = std::holds_alternative<StopProcess>(command.what);
  if (!stops && !c.can_answer()) return time_out(command);
  if (!how.takes) return stops ? stop(command) : carry_out(command);
  // A request that takes longer than the manager waits is carried out all the same, without a
  // reply.
  const bool is_late = *how.takes > command.timeout;
  if (is_late) time_out(command);
  plan(later(now_, *how.takes),
       [this, command, stops] { stops ? stop(command) : carry_out(command); });
}

void ScriptedRobot::carry_out(const Command& command) {
  simulation::Answer answer = components_[command.component.index].answer(command.what);
  if (answer.outcome == Outcome::kDone) tell_change(command);
  reply(command, answer.outcome, std::move(answer.value), std::move(answer.text));
}

void ScriptedRobot::tell_change(const Command& command) {
  if (std::holds_alternative<ChangeLifecycle>(command.what)) {
    has_changed_ = true;
    tell(LifecycleRead{command.component, components_[command.component.index].state});
  } else if (const auto* set = std::get_if<SetParameter>(&command.what)) {
    tell_parameter(command.component, set->name, set->value);
  }
}

void ScriptedRobot::tell_parameter(ComponentId component, const std::string& name,
                                   const Value& value) {
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    const Parameter& parameter = rules_.parameters[p];
    if (parameter.component == component && parameter.name == name)
      tell(ParameterRead{ParameterId(p), value});
  }
}

void ScriptedRobot::stop(const Command& command) {
  Component& c = components_[command.component.index];
  if (c.end())
    tell(ProcessSeen{command.component, ProcessState::kGone, c.pid, "stopped", Cause::kWish});
  c.is_in_graph = false;
  has_changed_ = true;
  reply(command, Outcome::kDone);
}

// The process runs at once; its node joins the graph after `takes`, in the state that the component
// had at the start of the test.
void ScriptedRobot::start(const Command& command, Duration takes) {
  Component& c = components_[command.component.index];
  c.start(++last_pid_);
  reply(command, Outcome::kDone, Value(std::int64_t{c.pid}));
  tell(ProcessSeen{command.component, ProcessState::kRunning, c.pid, ""});
  plan(later(now_, takes), [this, id = command.component, pid = c.pid] {
    Component& started = components_[id.index];
    if (started.pid != pid || started.process == ProcessState::kGone) return;
    started.is_in_graph = true;
    started.state = started.state_at_start;
    has_changed_ = true;
    appear(id);
    for (const auto& [name, value] : started.parameters) tell_parameter(id, name, value);
  });
}

}  // namespace culprit::rule_test
