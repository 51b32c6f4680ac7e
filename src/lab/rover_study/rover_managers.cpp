#include "rover_study/rover_managers.h"

#include <algorithm>

namespace culprit::study {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPatience = 5s;  // for an answer

}  // namespace

ProcessKeeper::Settings ProcessKeeper::respawn() { return {.restart_after = 2s}; }
ProcessKeeper::Settings ProcessKeeper::watchdog() {
  return {.restart_after = 100ms, .watchdog = 3s};
}

ProcessKeeper::ProcessKeeper(const RuleSet& rules, Settings settings)
    : rules_(rules),
      settings_(settings),
      kept_(rules.components.size()),
      is_periodic_(rules.topics.size()) {
  for (const Input& input : rules.inputs) {
    if (input.kind == Input::Kind::kAge) is_periodic_[input.topic.index] = true;
  }
}

void ProcessKeeper::observe(const Observation& observation) {
  if (const auto* seen = std::get_if<ProcessSeen>(&observation.what)) {
    Kept& kept = kept_[seen->component.index];
    if (seen->state == ProcessState::kRunning) kept = {};
    if (seen->state == ProcessState::kStopped) kept.beat = observation.at;
    if (seen->state != ProcessState::kGone) return;
    kept = {.start = later(observation.at, settings_.restart_after), .is_gone = true};
  } else if (const auto* probed = std::get_if<Probed>(&observation.what)) {
    Kept& kept = kept_[probed->component.index];
    kept.beat = probed->answered ? kNever : std::min(kept.beat, observation.at);
  } else if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) {
    for (std::size_t t = 0; t < is_periodic_.size(); ++t) {
      const Topic& topic = rules_.topics[t];
      if (!is_periodic_[t] || topic.name != end->name || end->kind != EndpointKind::kPublisher)
        continue;
      for (std::size_t c = 0; c < kept_.size(); ++c) {
        const bool is_meant = topic.publisher.value_or(ComponentId(c)) == ComponentId(c);
        if (is_meant && rules_.components[c].has_node(end->node))
          kept_[c].topics[TopicId(t)] = kNever;
      }
    }
  } else if (const auto* sample = std::get_if<SampleArrived>(&observation.what)) {
    for (Kept& kept : kept_) {
      const auto topic = kept.topics.find(sample->topic);
      if (topic != kept.topics.end()) topic->second = observation.at;
    }
  }
}

// When it is ended for its silence. A topic counts from its first sample on.
std::optional<Time> ProcessKeeper::watchdog_of(const Kept& kept) const {
  if (!settings_.watchdog || kept.is_gone) return std::nullopt;
  Time last = kept.beat;
  for (const auto& [topic, at] : kept.topics) last = std::min(last, at);
  return last == kNever ? std::nullopt : std::optional(later(last, *settings_.watchdog));
}

std::vector<Command> ProcessKeeper::step(Time now, std::span<const Observation> observations) {
  for (const Observation& each : observations) observe(each);
  std::vector<Command> commands;
  const auto ask = [&](std::size_t component, decltype(Command::what) what) {
    commands.push_back({{++last_command_}, ComponentId(component), std::move(what), kPatience, {}});
  };
  for (std::size_t c = 0; c < kept_.size(); ++c) {
    Kept& kept = kept_[c];
    const auto silent = watchdog_of(kept);
    if (kept.start && *kept.start <= now) {
      kept.start.reset();
      ask(c, StartProcess{});
    } else if (silent && *silent <= now) {
      kept = {.start = {}, .is_gone = true};  // its end is observed, and then it is started
      ask(c, StopProcess{.pid = 0, .hangs = true});
    }
  }
  return commands;
}

Time ProcessKeeper::next_deadline() const {
  Time next = kNever;
  for (const Kept& kept : kept_)
    next = std::min({next, kept.start.value_or(kNever), watchdog_of(kept).value_or(kNever)});
  return next;
}

RoverOracle::RoverOracle(const RuleSet& rules, std::vector<const rover::Fault*> faults, Time at)
    : ScriptedManager(rules, 1), rules_(rules) {
  for (const rover::Fault* fault : faults) run(mend(*fault, at));
}

Routine RoverOracle::mend(const rover::Fault& fault, Time at) {
  co_await sleep_until(at);
  const std::string& remedies = fault.remedies;
  const Request down = ChangeLifecycle{Transition::kDeactivate};
  const Request up = ChangeLifecycle{Transition::kActivate};
  if (!fault.is_fixable()) {
    co_await stand(fault.cause);
  } else if (remedies.starts_with("redeploy")) {
    co_await redeploy(fault.cause);
    const Request set = SetParameter{fault.parameter, Value(0.5)};
    if (remedies.ends_with("set_parameter")) (void)co_await ask(fault.cause, set, kPatience);
  } else if (remedies.starts_with("call")) {
    const Request call = CallService{remedies.substr(remedies.find('/')), ""};
    (void)co_await ask(fault.cause, call, kPatience);
  } else if (remedies.starts_with("set_parameter")) {
    const Request set = SetParameter{fault.parameter, Value(0.5)};
    (void)co_await ask(fault.cause, set, kPatience);
  } else {
    if (remedies.starts_with("restart")) (void)co_await ask(fault.cause, down, kPatience);
    (void)co_await ask(fault.cause, up, kPatience);
  }
}

// Until it is as it was. A base that counts from zero makes the rover look where it is.
Routine RoverOracle::redeploy(std::string component) {
  const Request stop = StopProcess{.pid = 0, .hangs = true};
  const Request start = StartProcess{};
  const Request read = Probe{};
  (void)co_await ask(component, stop, kPatience);
  for (bool is_there = false; !is_there;) {
    (void)co_await ask(component, start, kPatience);  // again, if it has exited
    co_await sleep(50ms);
    const Reply reply = co_await ask(component, read, 100ms);
    is_there = reply.outcome == Outcome::kDone;
  }
  const auto found = std::ranges::find(rules_.components, component, &Component::name);
  if (found->lifecycle == LifecycleDriver::kLauncher) {
    const Request configure = ChangeLifecycle{Transition::kConfigure};
    const Request activate = ChangeLifecycle{Transition::kActivate};
    (void)co_await ask(component, configure, kPatience);
    (void)co_await ask(component, activate, kPatience);
  }
  if (component != "base") co_return;
  co_await sleep(300ms);
  const Request look = CallService{"/reinitialize_global_localization", ""};
  (void)co_await ask("amcl", look, kPatience);
}

Routine RoverOracle::stand(std::string component) {
  const bool is_base = component == "base";
  const Request off = SetParameter{is_base ? "motor_power" : "stopped", Value(!is_base)};
  (void)co_await ask(is_base ? "base" : "e_stop", off, kPatience);
}

}  // namespace culprit::study
