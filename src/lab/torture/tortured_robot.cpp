#include "torture/tortured_robot.h"

#include <algorithm>
#include <utility>

namespace culprit::torture {
namespace {

using namespace std::chrono_literals;
using Kind = Mishap::Kind;

simulation::NodeTraits machine_traits() {
  simulation::NodeTraits traits;
  traits.start = {200ms, 200ms};
  traits.configure = 20ms;
  traits.end = {20ms, 80ms};
  traits.service = {2ms, 3ms};
  return traits;
}

bool take(std::vector<CommandId>& ids, CommandId id) { return std::erase(ids, id) > 0; }

// As the operating system reports it. "stopped": it was asked to end, by culprit or by another.
Cause cause_of(const ProcessSeen& seen) {
  if (seen.state == ProcessState::kRunning || seen.remark.empty())
    return seen.state == ProcessState::kStopped ? Cause::kFault : Cause::kUnknown;
  return seen.remark == "stopped" ? Cause::kWish : Cause::kFault;
}

}  // namespace

class Machine : public simulation::Node {
 public:
  Machine(simulation::World& world, std::size_t index, simulation::Topic<int>& own,
          const std::vector<simulation::Topic<int>*>& needs, simulation::Topic<int>* infrastructure)
      : Node(world, "/c" + std::to_string(index), machine_traits()),
        name_("c" + std::to_string(index)),
        out_(*this, own),
        heard_(needs.size(), kLongAgo) {
    declare("drift", 0.0);
    declare("safe", false);
    for (std::size_t i = 0; i < needs.size(); ++i) {
      in_.push_back(std::make_unique<simulation::Subscription<int>>(
          *this, *needs[i], [this, i](int) { heard_[i] = Node::world().now(); }));
    }
    if (infrastructure == nullptr) return;
    to_all_ = std::make_unique<simulation::Publisher<int>>(*this, *infrastructure);
    from_all_ = std::make_unique<simulation::Subscription<int>>(*this, *infrastructure, [](int) {});
  }

  void drift() { assign("drift", 1.0); }
  void break_down() { is_broken_ = true; }
  void burn() { is_burnt_ = true; }
  void ruin() { is_ruined_ = true; }
  void freeze() {
    is_frozen_ = process() != ProcessState::kGone;
    hang();
  }
  // It would not work even if it heard all that it needs.
  bool is_faulty() const { return is_frozen_ || !is_sound(); }
  // It works, and it does so in time: it does not hang.
  bool speaks() const {
    return works() && spoke_ != kLongAgo && Node::world().now() - spoke_ <= 2 * kPeriod;
  }
  void flap(Time until) { flaps_until_ = until; }

  bool works() const {
    const bool hears = std::all_of(heard_.begin(), heard_.end(), [this](Time at) {
      return at != kLongAgo && Node::world().now() - at <= 3 * kPeriod;
    });
    return process() == ProcessState::kRunning && is_active() && is_sound() && hears;
  }

 private:
  bool is_sound() const {
    constexpr Duration kTurn = 3s;
    const Time now = Node::world().now();
    const bool is_away = now < flaps_until_ && (now.time_since_epoch() / kTurn) % 2 == 0;
    return !is_broken_ && !is_burnt_ && !is_ruined_ && !is_away;
  }
  void on_activate() override { is_broken_ = false; }
  void on_start() override {
    is_broken_ = is_burnt_ = is_frozen_ = false;
    every(kPeriod, [this] {
      Node::world().diagnose(name_, "drift", *parameter("drift"));
      if (works()) {
        out_.publish(1);
        spoke_ = Node::world().now();
      }
      if (to_all_) to_all_->publish(1);
    });
  }

  std::string name_;
  simulation::Publisher<int> out_;
  std::vector<std::unique_ptr<simulation::Subscription<int>>> in_;
  std::vector<Time> heard_;
  bool is_broken_ = false;
  bool is_burnt_ = false;
  bool is_frozen_ = false;
  bool is_ruined_ = false;  // no new process helps
  Time flaps_until_ = kLongAgo;
  Time spoke_ = kLongAgo;
  std::unique_ptr<simulation::Publisher<int>> to_all_;
  std::unique_ptr<simulation::Subscription<int>> from_all_;
};

TorturedRobot::TorturedRobot(const Scenario& scenario, const RuleSet& rules)
    : rules_(rules),
      noise_(scenario.noise),
      world_(scenario.seed),
      random_(world_.random("noise")),
      launcher_of_(scenario.parts.size(), scenario.has_launcher ? kFirstLauncher : 0),
      started_here_(scenario.parts.size()),
      left_(scenario.parts.size(), kNever) {
  if (scenario.has_infrastructure)
    infrastructure_ = std::make_unique<simulation::Topic<int>>(
        world_, "/infrastructure", simulation::Transport{{1ms, 1ms}, 0});
  for (std::size_t i = 0; i < scenario.parts.size(); ++i) {
    topics_.push_back(std::make_unique<simulation::Topic<int>>(
        world_, "/c" + std::to_string(i), simulation::Transport{{1ms, 1ms}, 0}));
    std::vector<simulation::Topic<int>*> needs;
    for (const std::size_t other : scenario.parts[i].needs) needs.push_back(topics_[other].get());
    machines_.push_back(
        std::make_unique<Machine>(world_, i, *topics_[i], needs, infrastructure_.get()));
  }
  rediscover({});
  for (std::size_t i = 0; i < machines_.size(); ++i) {
    const Duration boots = scenario.parts[i].boots;
    if (boots == Duration::zero()) {
      machines_[i]->launch();
    } else {
      world_.after(boots, [this, i] { launch(i); });
    }
  }
  tell_base();
}

TorturedRobot::~TorturedRobot() = default;

void TorturedRobot::tell_base() {
  world_.diagnose("base", "moving", Value(moving_since_ != kNever));
  world_.after(kPeriod, [this] { tell_base(); });
}

TorturedRobot::Source TorturedRobot::source_of(const Observation& observation) {
  if (std::holds_alternative<SampleArrived>(observation.what) ||
      std::holds_alternative<SignalRead>(observation.what))
    return Source::kTopics;
  // Observations of the operating system, and replies of its adapter, come one after the other.
  if (std::holds_alternative<ProcessSeen>(observation.what) ||
      std::holds_alternative<LauncherSeen>(observation.what) ||
      std::holds_alternative<StartedHere>(observation.what) ||
      std::holds_alternative<Reply>(observation.what))
    return Source::kSystem;
  return Source::kGraph;
}

void TorturedRobot::receive(Observation observation) {
  if (is_of_a_stranger(observation)) return;
  const bool is_sample = std::holds_alternative<SampleArrived>(observation.what);
  if (is_sample && random_.chance(noise_.loss)) return;
  if (is_deaf() && source_of(observation) == Source::kTopics) return;
  if (auto* answer = std::get_if<Reply>(&observation.what)) {
    if (take(unanswered_, answer->command)) return;
    if (take(denied_, answer->command)) *answer = {answer->command, Outcome::kRefused, {}, "no"};
  }
  auto* process = std::get_if<ProcessSeen>(&observation.what);
  if (process != nullptr) process->cause = cause_of(*process);
  const bool is_launched = process != nullptr && process->state == ProcessState::kRunning &&
                           launcher_of_[process->component.index] != 0;
  const ComponentId component = process != nullptr ? process->component : ComponentId();
  const simulation::Span lateness{{}, noise_.lateness};
  auto& queue = on_the_way_[static_cast<std::size_t>(source_of(observation))];
  Time due = world_.now() + lateness.draw(random_);
  if (!queue.empty()) due = std::max(due, queue.back().due);
  if (process != nullptr && process->state == ProcessState::kRunning) {
    const StandIn& started = started_here_[component.index];
    if (started.pid == process->pid)
      queue.push_back({due, {now(), StartedHere{component, started.pid, started.launcher}}});
  }
  queue.push_back({due, observation});
  if (random_.chance(noise_.duplication)) queue.push_back({due, std::move(observation)});
  if (is_launched)
    queue.push_back({due, {now(), LauncherSeen{component, launcher_of_[component.index], false}}});
}

void TorturedRobot::observe(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  while (observations.size() == before) {
    const Time end = until == kNever ? kNever : std::max(world_.now(), until - ahead_);
    Time due = end;
    for (const auto& queue : on_the_way_) {
      if (!queue.empty()) due = std::min(due, queue.front().due);
    }
    std::vector<Observation> fresh;
    robots_.back()->observe(due, fresh);
    for (Observation& observation : fresh) receive(std::move(observation));
    for (auto& queue : on_the_way_) {
      while (!queue.empty() && queue.front().due <= world_.now()) {
        Observation& next = queue.front().observation;
        next.at = now() - (world_.now() < stale_until_ ? Duration(3s) : Duration());
        observations.push_back(std::move(next));
        queue.pop_front();
      }
    }
    if (world_.now() >= end) return;
  }
}

void TorturedRobot::execute(const Command& command) {
  if (random_.chance(noise_.lost_reply)) {
    unanswered_.push_back(command.id);
  } else if (!is_read(command) && random_.chance(noise_.false_success)) {
    return reply(command, Outcome::kDone);
  } else if (random_.chance(noise_.false_failure)) {
    denied_.push_back(command.id);
  }
  const std::size_t part = command.component.index;
  const bool starts =
      std::holds_alternative<StartProcess>(command.what) && process(part) == ProcessState::kGone;
  robots_.back()->execute(command);
  if (!starts) return;
  started_here_[part].pid = machines_[part]->pid();
  started_here_[part].is_ending = false;
  if (const int launcher = std::exchange(launcher_of_[part], 0); launcher != 0)
    started_here_[part].launcher = launcher;
}

void TorturedRobot::end_stand_in(std::size_t part, int pid) {
  StandIn& stand_in = started_here_[part];
  if (stand_in.pid != pid || std::exchange(stand_in.is_ending, true)) return;
  machines_[part]->terminate([] {});
}

void TorturedRobot::reply(const Command& command, Outcome outcome) {
  world_.after(5ms, [this, manager = robots_.size(), id = command.id, outcome] {
    if (manager == robots_.size()) receive({now(), Reply{id, outcome, {}, ""}});
  });
}

void TorturedRobot::befall(const Mishap& mishap) {
  Machine& machine = *machines_[mishap.part];
  switch (mishap.kind) {
    case Kind::kKill:
      return machine.kill();
    case Kind::kStop:
      return machine.stop();
    case Kind::kHang:
      return machine.freeze();
    case Kind::kDrift:
      if (machine.is_in_graph()) machine.drift();
      return;
    case Kind::kBreak:
      return machine.break_down();
    case Kind::kBurn:
      return machine.burn();
    case Kind::kBeyondRepair:
      return machine.ruin();
    case Kind::kJump:
      ahead_ += mishap.lasts;
      return;
    case Kind::kStaleStamp:
      stale_until_ = world_.now() + mishap.lasts;
      return;
    case Kind::kMove:
      if (moving_since_ == kNever) moving_since_ = world_.now();
      world_.after(mishap.lasts, [this] { moving_since_ = kNever; });
      return;
    case Kind::kFlap:
      return machine.flap(world_.now() + mishap.lasts);
    case Kind::kDeaf:
      return go_deaf(mishap.lasts);
    case Kind::kRival:
      return relaunch(mishap.part, world_.now() + mishap.lasts);
    case Kind::kTotalLoss:
      for (const auto& each : machines_) each->kill();
      return;
    case Kind::kLaunchEnds:
      return end_launch(mishap.lasts);
    case Kind::kNamesake:
      tell_namesakes(mishap.part, 1);
      world_.after(mishap.lasts, [this, part = mishap.part] { tell_namesakes(part, 0); });
      return;
    default:
      return;
  }
}

void TorturedRobot::launch(std::size_t part) {
  if (process(part) != ProcessState::kGone) return;
  machines_[part]->launch();
  launched_[part] = world_.now();
  started_here_[part] = {};
}

// One after the other, then their launcher; after `pause` all of the launch is started again, in the place of what
// stands in for it, too.
void TorturedRobot::end_launch(Duration pause) {
  const int launcher = *std::ranges::max_element(launcher_of_);
  if (launcher == 0) return;
  for (std::size_t part = 0; part < machines_.size(); ++part) {
    if (launcher_of_[part] != launcher) continue;
    world_.after(simulation::Span{{}, 1s}.draw(random_), [this, part, launcher] {
      Machine& machine = *machines_[part];
      const bool is_there = launcher_of_[part] == launcher && machine.is_in_graph() &&
                            machine.process() == ProcessState::kRunning;
      if (launcher_of_[part] != launcher) return;
      // One that is killed meanwhile is in the graph for a while longer: that is a crash.
      machine.terminate([this, part, is_there] {
        if (is_there && !machines_[part]->is_in_graph()) left_[part] = world_.now();
      });
    });
  }
  world_.after(kEndsOfLaunch, [this, launcher] {
    for (std::size_t part = 0; part < machines_.size(); ++part) {
      left_[part] = kNever;  // from now on it depends on why
      if (launcher_of_[part] == launcher)
        receive({now(), LauncherSeen{ComponentId(part), launcher, true}});
    }
  });
  world_.after(pause, [this, launcher] {
    for (std::size_t part = 0; part < machines_.size(); ++part) {
      const bool has_stand_in = launcher_of_[part] == 0 && started_here_[part].launcher == launcher;
      const auto start = [this, part, launcher] {
        if (process(part) != ProcessState::kGone) return;
        launcher_of_[part] = launcher + 1;
        launch(part);
      };
      if (has_stand_in) machines_[part]->terminate(start);
      if (launcher_of_[part] == launcher) start();
    }
  });
}

bool TorturedRobot::has_left_for(std::size_t part, Duration time) const {
  return left_[part] != kNever && world_.now() - left_[part] >= time;
}

void TorturedRobot::relaunch(std::size_t part, Time until) {
  constexpr Duration kLook = 300ms;
  if (world_.now() >= until) return;
  launch(part);
  world_.after(kLook, [this, part, until] { relaunch(part, until); });
}

// It is known to be deaf once its messages to itself do not return.
void TorturedRobot::go_deaf(Duration time) {
  constexpr Duration kKnown = 300ms;
  deaf_until_ = std::max(deaf_until_, world_.now() + time);
  world_.after(kKnown, [this] {
    if (is_deaf()) receive({now(), HearingLost{"nothing comes back"}});
  });
  world_.after(time + kKnown, [this] {
    if (!is_deaf()) receive({now(), HearingRegained{}});
  });
}

void TorturedRobot::tell_namesakes(std::size_t part, int others) {
  namesakes_[part] = others;
  receive({now(), NamesakesSeen{"/c" + std::to_string(part), others}});
}

// The end of a node is only observed if the node was announced.
bool TorturedRobot::is_of_a_stranger(const Observation& observation) {
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
    announced_.insert(node->node);
  } else if (const auto* gone = std::get_if<NodeVanished>(&observation.what)) {
    return announced_.erase(gone->node) == 0;
  } else if (const auto* end = std::get_if<EndpointVanished>(&observation.what)) {
    return !announced_.contains(end->node);
  }
  return false;
}

// A new observer discovers no node that is stopped, also while others still wait for it.
bool TorturedRobot::is_of_the_mute(const Observation& observation) const {
  const auto is_mute = [&](const std::string& node) {
    const simulation::Node* known = world_.node(node);
    return known != nullptr && known->process() != ProcessState::kRunning;
  };
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) return is_mute(node->node);
  if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) return is_mute(end->node);
  if (const auto* read = std::get_if<LifecycleRead>(&observation.what))
    return process(read->component.index) != ProcessState::kRunning;
  return false;
}

void TorturedRobot::rediscover(const History& past) {
  for (auto& queue : on_the_way_) queue.clear();
  unanswered_.clear();
  denied_.clear();
  robots_.push_back(std::make_unique<simulation::SimulatedRobot>(rules_, world_));
  announced_.clear();
  left_.assign(left_.size(), kNever);  // it knows of no launch that is being ended
  std::vector<Observation> seen;
  robots_.back()->observe(world_.now(), seen);
  for (Observation& observation : seen) {
    if (!is_of_the_mute(observation)) receive(std::move(observation));
  }
  for (const Event& event : past) {
    const auto* found = std::get_if<ComponentFound>(&event.what);
    if (found != nullptr && process(found->component.index) == ProcessState::kGone)
      receive({now(), ProcessSeen{found->component, ProcessState::kGone, found->pid, ""}});
  }
  for (const auto& [part, others] : namesakes_) tell_namesakes(part, others);
  if (is_deaf()) receive({now(), HearingLost{"nothing comes back"}});
}

bool TorturedRobot::works(std::size_t part) const {
  const Value* drift = machines_[part]->parameter("drift");
  return machines_[part]->speaks() && drift != nullptr && *drift == Value(0.0);
}

bool TorturedRobot::is_faulty(std::size_t part) const { return machines_[part]->is_faulty(); }

ProcessState TorturedRobot::process(std::size_t part) const { return machines_[part]->process(); }

}  // namespace culprit::torture
