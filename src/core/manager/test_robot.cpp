#include "manager/test_robot.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include <gtest/gtest.h>

namespace culprit::test {

TestRobot::TestRobot(const std::string& text, std::unique_ptr<const Planner> planner,
                     Manager::Options options) {
  const Source source("test.rules", text);
  Checked checked = check(source);
  for (const Diagnostic& d : checked.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(d, source);
  }
  rules_ = std::make_unique<RuleSet>(checked.rules.value_or(RuleSet{}));
  options.start = now;
  manager_ = std::make_unique<Manager>(*rules_, std::move(planner), options);
}

TestRobot::~TestRobot() {
  if (testing::Test::HasFailure()) std::cout << transcript(*this) << std::endl;
}

void TestRobot::replace_manager(std::unique_ptr<Manager> manager) {
  manager_ = std::move(manager);
  inbox_.clear();
  for (const auto& [name, component] : components_) {
    if (component.process == ProcessState::kRunning && component.is_in_graph) appear(component);
  }
  show_ends();
}

TestRobot::Component& TestRobot::add(const std::string& name, std::vector<std::string> needs,
                                     const std::string& topic, Duration period) {
  Component component;
  component.name = name;
  component.pid = ++last_pid_;
  component.needs = std::move(needs);
  if (!topic.empty()) topics_.push_back({topic, name, period, now});
  return components_[name] = component;
}

void TestRobot::discover(Duration then) {
  for (const auto& [name, component] : components_) appear(component);
  show_ends();
  step(then);
}

void TestRobot::show_ends() {
  const auto show = [this](const std::string& node, EndpointKind kind, const std::string& topic) {
    if (components_.at(node).process == ProcessState::kRunning)
      observe(EndpointAppeared{"/" + node, kind, topic});
  };
  for (const auto& [name, component] : components_) {
    for (const auto* producers : {&component.needs, &component.hears}) {
      for (const std::string& producer : *producers) {
        show(producer, EndpointKind::kPublisher, "/from_" + producer);
        show(name, EndpointKind::kSubscriber, "/from_" + producer);
      }
    }
  }
}

void TestRobot::appear(const Component& component) {
  const bool is_here = component.host.empty();
  if (is_here) observe(ProcessSeen{id(component.name), ProcessState::kRunning, component.pid, ""});
  observe(NodeAppeared{"/" + component.name, is_here ? component.pid : 0});
  if (!is_here) observe(LivesOn{id(component.name), component.host});
  if (component.has_lifecycle) observe(LifecycleRead{id(component.name), component.state});
}

ComponentId TestRobot::id(const std::string& name) const {
  for (std::size_t c = 0; c < rules_->components.size(); ++c) {
    if (rules_->components[c].name == name) return ComponentId(c);
  }
  ADD_FAILURE() << "the rules do not know component " << name;
  return {};
}

// All that it needs works, however far upstream; there may be loops.
bool TestRobot::works(const std::string& name) const {
  std::vector<std::string> needed{name};
  for (std::size_t next = 0; next < needed.size(); ++next) {
    const Component& c = components_.at(needed[next]);
    const bool is_up = c.process == ProcessState::kRunning && c.is_in_graph;
    if (is_cut_off(c)) return false;
    if (!is_up || c.state != Lifecycle::kActive || !c.fault.empty()) return false;
    for (const std::string& n : c.needs) {
      if (std::find(needed.begin(), needed.end(), n) == needed.end()) needed.push_back(n);
    }
  }
  return true;
}

void TestRobot::signal(const std::string& name, Value value, Duration then) {
  for (std::size_t s = 0; s < rules_->signals.size(); ++s) {
    if (rules_->signals[s].name == name) observe(SignalRead{SignalId(s), value});
  }
  step(then);
}

void TestRobot::fail(const std::string& name, const std::string& fault, Duration then) {
  components_.at(name).fault = fault;
  run_for(then);
}

void TestRobot::kill(const std::string& name, Duration then) {
  Component& component = components_.at(name);
  component.process = ProcessState::kGone;
  observe(ProcessSeen{id(name), ProcessState::kGone, component.pid, "killed by signal 9",
                      Cause::kFault});
  step(then);
}

void TestRobot::stop(const std::string& name, Duration then) {
  Component& component = components_.at(name);
  component.process = ProcessState::kStopped;
  observe(ProcessSeen{id(name), ProcessState::kStopped, component.pid, "", Cause::kFault});
  step(then);
}

void TestRobot::leave(const std::string& name, Duration then) {
  Component& component = components_.at(name);
  component.end();
  observe(NodeVanished{"/" + name});
  observe(ProcessSeen{id(name), ProcessState::kGone, component.pid, "exit code 0", Cause::kWish});
  step(then);
}

void TestRobot::start_by_hand(const std::string& name, Duration then) {
  Component& component = components_.at(name);
  component.start(++last_pid_);
  come_up(component);
  step(then);
}

void TestRobot::cut(const std::string& host, Duration then) {
  constexpr Duration kUntilSilent = 4s;
  constexpr Duration kLease = 20s;
  cut_.insert(host);
  const auto while_cut = [this, host](const std::function<void()>& action) {
    return [this, host, action] {
      if (cut_.contains(host)) action();
    };
  };
  later(kUntilSilent, while_cut([this, host] {
          told_silent_.insert(host);
          observe(HostHeard{host, false});
        }));
  later(kLease, while_cut([this, host] {
          for (auto& [name, component] : components_) {
            if (component.host != host) continue;
            component.is_in_graph = false;
            observe(NodeVanished{"/" + name});
          }
        }));
  if (then > Duration::zero()) run_for(then);
}

void TestRobot::mend(const std::string& host, Duration then) {
  constexpr Duration kAnnounced = 1s;
  cut_.erase(host);
  later(kAnnounced, [this, host] {
    if (cut_.contains(host)) return;
    if (told_silent_.erase(host) > 0) observe(HostHeard{host, true});
    for (auto& [name, component] : components_) {
      if (component.host != host || component.process != ProcessState::kRunning) continue;
      if (!std::exchange(component.is_in_graph, true)) appear(component);
      observe(Probed{id(name), true});
    }
    show_ends();
  });
  if (then > Duration::zero()) run_for(then);
}

void TestRobot::later(Duration delay, std::function<void()> action) {
  agenda_.emplace(now + delay, std::move(action));
}

void TestRobot::run_for(Duration time) {
  const Time end = now + time;
  while (true) {
    Time next = std::min(end, std::max(now, manager_->next_deadline()));
    for (const Topic& topic : topics_) next = std::min(next, topic.next);
    if (!agenda_.empty()) next = std::min(next, agenda_.begin()->first);
    now = next;
    for (Topic& topic : topics_) {
      if (topic.next > now) continue;
      topic.next += topic.period;
      if (!works(topic.producer)) continue;
      if (loses && loses(topic.name)) {
        ++topic.lost;
        continue;
      }
      const std::uint32_t sent = std::exchange(topic.lost, 0u) + 1;
      for (std::size_t t = 0; t < rules_->topics.size(); ++t) {
        if (rules_->topics[t].name == topic.name) observe(SampleArrived{TopicId(t), sent});
      }
    }
    while (!agenda_.empty() && agenda_.begin()->first <= now) {
      const auto action = std::move(agenda_.begin()->second);
      agenda_.erase(agenda_.begin());
      action();
    }
    step();
    if (now >= end) return;
  }
}

void TestRobot::freeze(Duration time) {
  now += time;
  for (Topic& topic : topics_) topic.next += time;
  std::multimap<Time, std::function<void()>> agenda;
  for (auto& [at, action] : agenda_) agenda.emplace(at + time, std::move(action));
  agenda_ = std::move(agenda);
}

void TestRobot::step(Duration then) {
  const std::vector<Command> commands = manager_->step(now, inbox_);
  for (const Event& event : manager_->events()) {
    events.push_back(event);
    const std::string line = describe(event, *rules_);
    if (!line.empty()) said.push_back(line);
  }
  if (after_step) after_step();
  const bool lives = !before_commands || before_commands(inbox_, commands);
  inbox_.clear();
  if (lives) {
    for (const Command& command : commands) {
      asked.push_back(rules_->components[command.component.index].name + ": " + to_string(command));
      later(5ms, [this, command] { serve(command); });
    }
  }
  if (then > Duration::zero()) run_for(then);
}

void TestRobot::reply(const Command& command, Outcome outcome, decltype(Reply::value) value,
                      std::string text) {
  observe(Reply{command.id, outcome, std::move(value), std::move(text)});
}

void TestRobot::serve(const Command& command) {
  Component& c = components_.at(rules_->components[command.component.index].name);
  const bool is_of_process = std::holds_alternative<StopProcess>(command.what) ||
                             std::holds_alternative<StartProcess>(command.what);
  if (!c.host.empty() && is_of_process)
    return reply(command, Outcome::kUnreachable, {}, "it is on another computer");
  if (const auto* stop = std::get_if<StopProcess>(&command.what)) {
    if (c.ends_only_if_killed && !stop->hangs) return;
    if (c.end())
      observe(ProcessSeen{command.component, ProcessState::kGone, c.pid, "stopped", Cause::kWish});
    return reply(command, Outcome::kDone);
  }
  if (std::holds_alternative<StartProcess>(command.what)) return start(c, command);
  if (is_cut_off(c) || !c.can_answer()) {
    return later(command.timeout + c.lateness,
                 [this, command] { reply(command, Outcome::kTimedOut); });
  }
  simulation::Answer result = answer(c, command);
  resolve_fault(c, command, result.outcome == Outcome::kDone);
  const bool is_lost = c.loses_replies && result.outcome == Outcome::kDone && !is_read(command);
  if (is_lost)
    return later(command.timeout, [this, command] { reply(command, Outcome::kTimedOut); });
  reply(command, result.outcome, std::move(result.value), std::move(result.text));
}

simulation::Answer TestRobot::answer(Component& c, const Command& command) {
  const bool is_set = std::holds_alternative<SetParameter>(command.what);
  const auto* change = std::get_if<ChangeLifecycle>(&command.what);
  if (c.refuses && !is_read(command)) return {Outcome::kRefused, {}, is_set ? "read-only" : ""};
  if (is_set && c.ignores_parameters) return {};
  const bool fails = change != nullptr && change->transition == Transition::kActivate &&
                     c.state == Lifecycle::kInactive && c.fails_to_activate;
  simulation::Answer result =
      fails ? simulation::Answer{Outcome::kRefused} : c.answer(command.what);
  if (fails) c.state = Lifecycle::kUnconfigured;
  if (fails || (change != nullptr && result.outcome == Outcome::kDone))
    observe(LifecycleRead{command.component, c.state});
  return result;
}

void TestRobot::resolve_fault(Component& c, const Command& command, bool is_done) {
  const auto* change = std::get_if<ChangeLifecycle>(&command.what);
  const auto* set = std::get_if<SetParameter>(&command.what);
  if (!is_done) return;
  if (change != nullptr && change->transition == Transition::kActivate && c.fault == "restart")
    c.fault.clear();
  if (set != nullptr && c.fault == set->name + "=" + to_string(set->value)) c.fault.clear();
}

void TestRobot::start(Component& c, const Command& command) {
  if (!c.start_missing.empty()) {
    observe(StartBarred{command.component, c.start_missing});
    return reply(command, Outcome::kUnreachable, {}, c.start_missing);
  }
  c.start(++last_pid_);
  if (c.answers_after_start > Duration::zero()) {
    c.answers = false;
    later(c.answers_after_start, [&c] { c.answers = true; });
  }
  reply(command, Outcome::kDone, Value(std::int64_t{c.pid}));
  observe(StartedHere{command.component, c.pid, c.launcher});
  observe(ProcessSeen{command.component, ProcessState::kRunning, c.pid, ""});
  if (c.dies_at_start) {
    return later(50ms, [this, &c, command] {
      c.end();
      observe(
          ProcessSeen{command.component, ProcessState::kGone, c.pid, "exit code 1", Cause::kFault});
    });
  }
  later(c.start_time, [this, &c] { come_up(c); });
}

void TestRobot::come_up(Component& c) {
  c.is_in_graph = true;
  c.state = c.state_at_start;
  if (c.fault == "restart" || c.fault == "redeploy") c.fault.clear();
  appear(c);
  if (c.activates_itself_after > Duration::zero())
    later(c.activates_itself_after, [this, &c, pid = c.pid] { activate_itself(c, pid); });
}

void TestRobot::activate_itself(Component& c, int pid) {
  if (c.pid != pid || c.process == ProcessState::kGone) return;
  if (c.state == Lifecycle::kUnconfigured) {
    c.state = Lifecycle::kActive;
    observe(LifecycleRead{id(c.name), c.state});
  } else if (c.leaves_before_it_ends) {
    c.fault = "redeploy";  // it does nothing more
    observe(NodeVanished{"/" + c.name});
    later(300ms, [this, &c, pid] {
      if (c.pid != pid || c.process == ProcessState::kGone) return;
      c.process = ProcessState::kGone;
      observe(ProcessSeen{id(c.name), ProcessState::kGone, pid, "killed by signal 2"});
    });
  } else {
    c.process = ProcessState::kGone;
    observe(ProcessSeen{id(c.name), ProcessState::kGone, pid, "exit code 1", Cause::kFault});
  }
}

std::size_t TestRobot::count(const std::string& part) const {
  return static_cast<std::size_t>(
      std::count_if(said.begin(), said.end(),
                    [&](const std::string& line) { return line.find(part) != std::string::npos; }));
}

std::size_t TestRobot::count_asked(const std::string& part) const {
  return static_cast<std::size_t>(
      std::count_if(asked.begin(), asked.end(),
                    [&](const std::string& line) { return line.find(part) != std::string::npos; }));
}

std::string rules_of_camera_and_lamp(const std::string& head, const std::string& camera) {
  return head + "COMPONENT camera NODE /camera LAUNCH \"camera\" " + camera + R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT lamp   NODE /lamp
RULE CameraSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 20
RULE FusionSilent
  POLICIES WARNING
  TRIGGER age(/fused) > 300ms
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 10
RULE Dark
  POLICIES NON_CRITICAL
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
)";
}

void add_camera_and_lamp(TestRobot& robot) {
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  robot.add("lamp").parameters["on"] = Value(std::int64_t{0});
}

std::string transcript(const TestRobot& robot) {
  std::string out;
  for (const std::string& line : robot.said) out += "\n  said  " + line;
  for (const std::string& line : robot.asked) out += "\n  asked " + line;
  return out;
}

}  // namespace culprit::test
