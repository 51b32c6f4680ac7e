#include "rca_study/rca_robot.h"

#include <algorithm>
#include <cmath>

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAnswer = 5ms;  // of a request that takes no time
constexpr Duration kEnding = 200ms;
const std::string kTuning = "tuning";

std::string node_of(const RcaComponent& component) { return "/" + component.name; }

}  // namespace

RcaRobot::RcaRobot(const RcaScenario& scenario, const RuleSet& rules, Duration quiet)
    : scenario_(scenario),
      quiet_(quiet),
      plant_(scenario),
      noise_(simulation::mix(scenario.seed + 1)),
      luck_(simulation::mix(scenario.seed + 2)),
      bodies_(scenario.components.size()),
      parameters_(scenario.components.size()),
      signals_(scenario.components.size()) {
  plant_.on_fault = [this](std::size_t c) { on_fault(c); };
  for (std::size_t p = 0; p < rules.parameters.size(); ++p)
    parameters_[rules.parameters[p].component.index] = ParameterId(p);
  for (std::size_t c = 0, s = 0; c < bodies_.size(); ++c) {
    if (!scenario.components[c].is_unwatched) signals_[c] = SignalId(s++);
    false_alarms_.push_back({simulation::Random(simulation::mix(scenario.seed + 3) + c)});
  }
  for (std::size_t c = 0; c < bodies_.size(); ++c) {
    bodies_[c].parameters[kTuning] = 1.0;
    bodies_[c].start(++last_pid_);
    appear(c);
  }
  for (const RcaTopic& topic : scenario.topics) {
    for (const std::size_t p : topic.publishers)
      tell(EndpointAppeared{node_of(scenario.components[p]), EndpointKind::kPublisher, topic.name});
    for (const Subscription& s : topic.subscribers) {
      if (!s.is_hidden)
        tell(EndpointAppeared{node_of(scenario.components[s.component]), EndpointKind::kSubscriber,
                              topic.name});
    }
  }
  read_detectors();
}

void RcaRobot::observe(Time until, std::vector<Observation>& observations) {
  while (inbox_.empty() && plant_.step(until)) continue;
  if (observations.empty()) return observations.swap(inbox_);
  std::move(inbox_.begin(), inbox_.end(), std::back_inserter(observations));
  inbox_.clear();
}

void RcaRobot::appear(std::size_t component) {
  simulation::Body& body = bodies_[component];
  body.is_in_graph = true;
  body.state = Lifecycle::kActive;
  const ComponentId id(component);
  tell(ProcessSeen{id, ProcessState::kRunning, body.pid, ""});
  tell(NodeAppeared{node_of(scenario_.components[component]), body.pid});
  tell(Probed{id, true});
  tell(LifecycleRead{id, body.state});
  if (parameters_[component])
    tell(ParameterRead{*parameters_[component], *body.parameter(kTuning)});
}

// All at once, and so is the end of the episode seen.
void RcaRobot::read_detectors() {
  for (std::size_t c = 0; c < bodies_.size(); ++c) {
    const Detector& detector = scenario_.components[c].detector;
    if (!signals_[c]) continue;
    const bool looks_ill = plant_.looks_ill(c) || is_false_alarm(c);
    const bool is_wrong = noise_.chance(looks_ill ? detector.miss : detector.false_alarm);
    tell(SignalRead{*signals_[c], Value(looks_ill != is_wrong)});
  }
  if (!plant_.is_well()) well_since_.reset();
  if (plant_.is_well() && !well_since_) well_since_ = now();
  const bool is_quiet = well_since_ && now() >= later(*well_since_, quiet_);
  is_over_ = is_quiet || now() >= Time(from_seconds(scenario_.horizon_s));
  if (!is_over_) plant_.after(from_seconds(scenario_.reading_s), [this] { read_detectors(); });
}

// Alarms of 1 to 5 s, as often as the detector has them (a Poisson process).
bool RcaRobot::is_false_alarm(std::size_t component) {
  const double per_min = scenario_.components[component].detector.false_alarms_per_min;
  if (per_min <= 0) return false;
  FalseAlarm& alarm = false_alarms_[component];
  const double now_s = seconds(now().time_since_epoch());
  while (alarm.ends_s <= now_s) {
    alarm.begins_s = alarm.ends_s - std::log(1 - alarm.luck.uniform()) * 60 / per_min;
    alarm.ends_s = alarm.begins_s + alarm.luck.uniform(1, 5);
  }
  return alarm.begins_s <= now_s;
}

void RcaRobot::on_fault(std::size_t component) {
  const FaultKind kind = *plant_.fault(component);
  if (kind == FaultKind::kCrash) lose(component, "killed by signal 11");
  if (kind == FaultKind::kHang) bodies_[component].answers = false;
  if (kind == FaultKind::kWrongParameter) bodies_[component].parameters[kTuning] = 0.0;
}

void RcaRobot::lose(std::size_t component, const std::string& remark) {
  simulation::Body& body = bodies_[component];
  if (!body.is_in_graph) return;
  body.end();
  body.is_in_graph = false;
  tell(ProcessSeen{ComponentId(component), ProcessState::kGone, body.pid, remark});
  tell(NodeVanished{node_of(scenario_.components[component])});
}

void RcaRobot::execute(const Command& command) {
  open_.insert(command.id);
  const std::size_t component = command.component.index;
  if (std::holds_alternative<StopProcess>(command.what)) {
    plant_.set_down(component, true);
    plant_.after(kEnding, [this, component, id = command.id] {
      lose(component, "terminated");
      reply(id, Outcome::kDone);
    });
  } else if (std::holds_alternative<StartProcess>(command.what)) {
    start(command);
  } else if (!bodies_[component].is_in_graph) {
    plant_.after(kAnswer, [this, id = command.id] { reply(id, Outcome::kUnreachable); });
  } else {
    plant_.after(command.timeout, [this, id = command.id] { reply(id, Outcome::kTimedOut); });
    plant_.after(kAnswer, [this, command] {
      if (bodies_[command.component.index].can_answer()) serve(command);
    });
  }
}

// Changes take their time; other requests are answered at once.
void RcaRobot::serve(const Command& command) {
  const std::size_t component = command.component.index;
  if (const auto* transition = std::get_if<ChangeLifecycle>(&command.what)) {
    change(command, transition->transition);
  } else if (const auto* set = std::get_if<SetParameter>(&command.what)) {
    const simulation::Answer said = bodies_[component].answer(command.what);
    const bool is_repair = said.outcome == Outcome::kDone && set->value == Value(1.0);
    plant_.after(duration(component, Repair::kConfigure),
                 [this, component, is_repair, outcome = said.outcome, id = command.id] {
                   if (is_repair) take_effect(component, Repair::kConfigure);
                   reply(id, outcome);
                 });
  } else {
    simulation::Answer said = bodies_[component].answer(command.what);
    reply(command.id, said.outcome, std::move(said.value));
  }
}

// A restart is a deactivation and an activation of half its time each.
void RcaRobot::change(const Command& command, Transition transition) {
  const std::size_t component = command.component.index;
  const bool is_up = transition == Transition::kActivate;
  if (!is_up) plant_.set_down(component, true);
  plant_.after(duration(component, Repair::kRestart) / 2,
               [this, component, is_up, id = command.id, transition, pid = bodies_[component].pid] {
                 simulation::Body& body = bodies_[component];
                 if (body.pid != pid || !body.can_answer()) return;
                 if (!body.change(transition)) return reply(id, Outcome::kRefused);
                 if (is_up) {
                   take_effect(component, Repair::kRestart);
                   plant_.set_down(component, false);
                 }
                 tell(LifecycleRead{ComponentId(component), body.state});
                 reply(id, Outcome::kDone);
               });
}

void RcaRobot::start(const Command& command) {
  const std::size_t component = command.component.index;
  plant_.set_down(component, true);
  bodies_[component].start(++last_pid_);
  reply(command.id, Outcome::kDone, Value(std::int64_t{bodies_[component].pid}));
  const Duration takes = duration(component, Repair::kRedeploy) - kEnding;
  plant_.after(std::max(takes, kAnswer), [this, component] {
    take_effect(component, Repair::kRedeploy);
    bodies_[component].answers = plant_.fault(component) != FaultKind::kHang;
    bodies_[component].parameters[kTuning] =
        plant_.fault(component) == FaultKind::kWrongParameter ? 0.0 : 1.0;
    appear(component);
    plant_.set_down(component, false);
    if (plant_.fault(component) == FaultKind::kCrash)
      plant_.after(kEnding, [this, component] { lose(component, "killed by signal 11"); });
  });
}

// Each attempt has its own luck.
void RcaRobot::take_effect(std::size_t component, Repair repair) {
  const auto kind = plant_.fault(component);
  const bool is_unfixable = std::any_of(
      scenario_.faults.begin(), scenario_.faults.end(),
      [&](const InjectedFault& f) { return f.component == component && f.is_unfixable; });
  bool has_helped = false;
  for (const Treatment& t : scenario_.components[component].treatments) {
    has_helped |= kind && !is_unfixable && t.repair == repair &&
                  luck_.chance(t.helps[static_cast<std::size_t>(*kind)]);
  }
  if (has_helped) plant_.repair(component);
  if (on_effect) on_effect(component, repair, has_helped);
}

Duration RcaRobot::duration(std::size_t component, Repair repair) const {
  for (const Treatment& t : scenario_.components[component].treatments) {
    if (t.repair == repair) return from_seconds(t.takes_s);
  }
  return kAnswer;
}

void RcaRobot::reply(CommandId command, Outcome outcome, decltype(Reply::value) value) {
  if (open_.erase(command) > 0) tell(Reply{command, outcome, std::move(value), ""});
}

}  // namespace culprit::study::rca
