// Processes, lifecycles and requests; the data between the nodes are in rover_flow.cpp.
#include "exemplars/rover/model/rover_model.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

#include "exemplars/rover/nodes.h"

namespace culprit::rover::model {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAnswer = 10ms;  // of a request that takes no time: the two ways of a service
constexpr Duration kTransition = 40ms;  // of a lifecycle, as the live rover's servers need
constexpr Duration kEnds = 150ms;       // after SIGINT: the live rover's nodes end in 0.1 to 0.2 s
constexpr Duration kEscalates =
    2s;  // until the supervisor sends SIGKILL to a process that hangs (owners/supervisor_ending.cpp)
constexpr Duration kLease = 20s;        // of a killed participant (Fast DDS)
constexpr Duration kDiscovery = 300ms;  // until others know a new node
constexpr Duration kFirstProbe =
    900ms;  // 400 ms between probes, 500 ms for the answer (link/link.cpp)
constexpr Duration kProbePeriod = 400ms;
constexpr Duration kRespawns = 2s;  // as launch's respawn_delay in demo/rover_demo.cpp
constexpr Duration kWithdraws = 1s;

// kill:camera, imu, twist_mux, e_stop heal live in 0.4 to 1.0 s, of which the start takes nearly all.
constexpr double kStartLeast_s = 0.25;
constexpr double kStartMost_s = 0.75;
// Servers need longer: at the same load none of seven that respawned after 2 s was back before its bond broke, after 3 to 4 s.
constexpr double kServerLeast_s = 1.0;
constexpr double kServerMost_s = 2.0;

// As the nodes offer them in set_up(): > publishes, < subscribes to, = serves, ? asks (an action's send_goal). All publish on
// /diagnostics and /bond, which the rules ignore.
constexpr std::pair<const char*, const char*> kEndpoints[] = {
    {"lidar", ">/scan"},
    {"camera", ">/camera/image_raw"},
    {"cloud_maker", ">/points </camera/image_raw"},
    {"imu", ">/imu"},
    {"base", ">/odom >/tf >/battery_state </cmd_vel"},
    {"map_server", ">/map"},
    {"amcl", ">/tf >/amcl_pose </tf </map </scan =/reinitialize_global_localization"},
    {"planner_server",
     ">/plan >/global_costmap/costmap </tf </map </scan "
     "=/compute_path_to_pose/_action/send_goal"},
    {"controller_server",
     ">/cmd_vel_nav >/local_costmap/costmap </tf </scan =/follow_path/_action/send_goal"},
    {"behavior_server", ">/cmd_vel_nav </tf =/spin/_action/send_goal =/backup/_action/send_goal"},
    {"velocity_smoother", ">/cmd_vel_smoothed </cmd_vel_nav"},
    {"bt_navigator",
     "</tf =/navigate_to_pose/_action/send_goal ?/compute_path_to_pose/_action/send_goal "
     "?/follow_path/_action/send_goal ?/spin/_action/send_goal ?/backup/_action/send_goal"},
    {"twist_mux", ">/cmd_vel </cmd_vel_smoothed </e_stop"},
    {"e_stop", ">/e_stop"}};

EndpointKind kind_of(char sign) {
  return sign == '>'   ? EndpointKind::kPublisher
         : sign == '<' ? EndpointKind::kSubscriber
         : sign == '=' ? EndpointKind::kServer
                       : EndpointKind::kClient;
}

}  // namespace

RoverModel::RoverModel(const RuleSet& rules, Options options)
    : rules_(rules),
      withdraws_(options.withdraws),
      random_(options.seed),
      trip_(simulation::Random(random_.next())) {
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    const auto& source = rules.signals[s].source;
    if (const auto* key = std::get_if<DiagnosticKey>(&source))
      signals_[key->status + " " + key->key].push_back(SignalId(s));
    if (const auto* field = std::get_if<TopicField>(&source))
      signals_[rules[field->topic].name + " " + field->field].push_back(SignalId(s));
  }
  make_parts();
  make_managers(options.has_bonds);
  tick();
}

void RoverModel::make_parts() {
  parts_.resize(rules_.components.size());
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    const Component& component = rules_.components[c];
    Part& part = parts_[c];
    ids_.emplace(component.name, ComponentId(c));
    part.name = component.node.substr(1);
    part.is_server = is_server(component.node);
  }
  for (const Fault& fault : faults()) {
    const auto found = ids_.find(fault.cause);
    if (found != ids_.end() && fault.remedies.starts_with("restart"))
      parts_[found->second.index].healed_by_activation.push_back(
          std::get<std::string>(fault.value));
  }
  part("controller_server").at_start["max_speed"] = 0.5;
  part("base").at_start["motor_power"] = true;
  part("camera").at_start["exposure"] = 1.0;
  part("e_stop").at_start["stopped"] = false;
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    Part& part = parts_[c];
    start_process(ComponentId(c));
    tell(ProcessSeen{ComponentId(c), ProcessState::kRunning, part.pid, ""});
    appear(ComponentId(c));
    if (!part.is_server) continue;
    change(ComponentId(c), Transition::kConfigure);
    change(ComponentId(c), Transition::kActivate);
  }
}

void RoverModel::make_managers(bool has_bonds) {
  for (const Group& group : rules_.groups) {
    const auto id = [&group](std::size_t s) { return group.members[s]; };
    auto manager = std::make_unique<BondManager>(
        BondManager::Servers{
            .count = group.members.size(),
            .reach = [this, id](std::size_t s) { return reach(parts_[id(s).index]); },
            .pid = [this, id](std::size_t s) { return parts_[id(s).index].known_pid; },
            .change = [this, id](std::size_t s, Transition t) { return change(id(s), t); },
            .answer_time = [this] { return from_seconds(random_.uniform(0.03, 0.08)); }},
        has_bonds);
    manager->begin_active(now_);
    managers_.emplace(group.manager, std::move(manager));
  }
}

void RoverModel::observe(Time until, std::vector<Observation>& observations) {
  while (inbox_.empty() && agenda_.next() <= until) {
    now_ = std::max(now_, agenda_.next());
    agenda_.take()();
  }
  if (inbox_.empty()) now_ = std::max(now_, until);
  std::move(inbox_.begin(), inbox_.end(), std::back_inserter(observations));
  inbox_.clear();
}

// ---- processes

bool RoverModel::works(const Part& part) const {
  return part.can_answer() && (!part.is_server || part.state == Lifecycle::kActive);
}

bool RoverModel::is_healthy(ComponentId id) const {
  const Part& part = parts_[id.index];
  const auto manager = managers_.find(id);
  return works(part) && part.fault.empty() &&
         (manager == managers_.end() || !manager->second->is_stuck());
}

BondManager::Reach RoverModel::reach(const Part& part) const {
  const bool is_there = !part.is_gone() && part.is_in_graph;
  const bool is_known = is_there && now_ >= later(part.appeared, kDiscovery);
  if (is_known)
    return part.can_answer() ? BondManager::Reach::kAnswers : BondManager::Reach::kBlocks;
  return now_ < later(part.killed, kLease) ? BondManager::Reach::kBlocks
                                           : BondManager::Reach::kNobody;
}

// A component runs in the process of its container, which rover.rules declares before it.
void RoverModel::start_process(ComponentId id) {
  const auto container = container_of(id, rules_);
  parts_[id.index].start(container ? parts_[container->index].pid : ++last_pid_);
}

void RoverModel::start(ComponentId id) {
  Part& part = parts_[id.index];
  start_process(id);
  part.fault.clear();
  tell(ProcessSeen{id, ProcessState::kRunning, part.pid, ""});
  if (now_ < part.busy_until) {
    return after(kEnds, [this, id, pid = part.pid] {
      if (parts_[id.index].pid == pid) lose(id, "exit code 1", Cause::kFault, true);
    });
  }
  double start_s = part.is_server ? random_.uniform(kServerLeast_s, kServerMost_s)
                                  : random_.uniform(kStartLeast_s, kStartMost_s);
  if (part.next == "start_s") start_s += std::get<double>(part.next_value);
  if (part.next == "start_s") part.next.clear();
  after(from_seconds(start_s), [this, id, pid = part.pid] {
    const Part& started = parts_[id.index];
    if (started.pid == pid && !started.is_gone()) appear(id);
  });
}

void RoverModel::appear(ComponentId id) {
  Part& part = parts_[id.index];
  part.is_in_graph = true;
  part.appeared = now_;
  part.known_pid = part.pid;
  part.phase = kTick * random_.below(20);
  part.memory_mib = 30;
  part.state = part.is_server ? Lifecycle::kUnconfigured : Lifecycle::kUnknown;
  part.parameters = part.at_start;
  part.set_parameter(std::exchange(part.next, ""), part.next_value);
  tell(NodeAppeared{rules_[id].node, part.pid});
  for (const std::string& other : rules_[id].other_nodes) tell(NodeAppeared{other, part.pid});
  tell(Probed{id, true});
  if (part.is_server) tell(LifecycleRead{id, part.state});
  if (!part.is_server) tell_endpoints(id, true);
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    const Value* value = part.parameter(rules_.parameters[p].name);
    if (rules_.parameters[p].component == id && value != nullptr)
      tell(ParameterRead{ParameterId(p), *value});
  }
  const std::string& name = rules_[id].name;
  // It counts from zero: the rover has jumped.
  if (name == "base" && now_ > Time{}) pose_error_ += 2;
  if (name == "bt_navigator") trip_.forget();
  if (name == "planner_server") has_costs_ = false;
  const auto manager = managers_.find(id);
  if (manager != managers_.end() && now_ > Time{}) manager->second->begin(now_);
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    if (container_of(ComponentId(c), rules_) == id && parts_[c].is_gone()) start(ComponentId(c));
  }
}

void RoverModel::tell_endpoints(ComponentId id, bool is_there) {
  const auto found = std::ranges::find(
      kEndpoints, rules_[id].name, [](const auto& each) { return std::string_view(each.first); });
  std::istringstream words(found == std::end(kEndpoints) ? "" : found->second);
  for (std::string word; words >> word;) {
    const EndpointKind kind = kind_of(word.front());
    if (is_there) tell(EndpointAppeared{rules_[id].node, kind, word.substr(1)});
    if (!is_there) tell(EndpointVanished{rules_[id].node, kind, word.substr(1)});
  }
}

void RoverModel::lose(ComponentId id, const std::string& remark, Cause cause, bool says_goodbye) {
  Part& part = parts_[id.index];
  if (!part.end()) return;
  part.is_in_graph = false;
  if (!says_goodbye) part.killed = now_;
  const auto container = container_of(id, rules_);
  if (!container || parts_[container->index].is_gone())
    tell(ProcessSeen{id, ProcessState::kGone, part.pid, remark, cause});
  tell(NodeVanished{rules_[id].node});
  for (const std::string& other : rules_[id].other_nodes) tell(NodeVanished{other});
  if (rules_[id].is_respawned) after(kRespawns, [this, id] { start(id); });
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    if (container_of(ComponentId(c), rules_) == id)
      lose(ComponentId(c), remark, cause, says_goodbye);
  }
}

bool RoverModel::change(ComponentId id, Transition transition) {
  Part& part = parts_[id.index];
  if (!part.change(transition)) return false;
  const std::string& name = rules_[id].name;
  if (transition == Transition::kConfigure) {
    tell_endpoints(id, true);
    if (name == "amcl") has_map_ = false;
  } else if (transition == Transition::kCleanup) {
    tell_endpoints(id, false);
  } else if (transition == Transition::kActivate) {
    if (std::ranges::find(part.healed_by_activation, part.fault) != part.healed_by_activation.end())
      part.fault.clear();
  }
  tell(LifecycleRead{id, part.state});
  return true;
}

// A process that hangs is asked again and again, until it is another.
void RoverModel::probe(ComponentId id, int pid) {
  const Part& part = parts_[id.index];
  if (part.pid != pid || part.answers || !part.is_running()) return;
  tell(Probed{id, false});
  after(kProbePeriod, [this, id, pid] { probe(id, pid); });
}

// ---- faults

void RoverModel::inject(const Fault& fault) {
  if (fault.name == "kidnapped") pose_error_ = 4;
  if (fault.parameter == "lidar_plugged") is_plugged_ = false;
  if (fault.parameter == "lidar_flaps") flaps_since_ = now_;
  if (fault.parameter == "battery") charge_ = std::get<double>(fault.value);
  if (fault.process == "world") return;
  if (fault.way == Way::kStray) {
    strays_.insert(fault.process);
    if (fault.is_fixable()) tell(NamesakesSeen{"/" + fault.process, 1});
    if (fault.is_fixable() && withdraws_)
      after(kWithdraws, [this, process = fault.process] {
        strays_.erase(process);
        tell(NamesakesSeen{"/" + process, 0});
      });
    return;
  }
  const ComponentId id = ids_.at(fault.cause);
  Part& part = parts_[id.index];
  if (fault.way == Way::kKill) return lose(id, "killed by signal 9", Cause::kFault, false);
  if (fault.way == Way::kNextStart) {
    part.next = fault.parameter;
    part.next_value = fault.value;
    if (part.next == "busy_s")
      part.busy_until = later(now_, from_seconds(std::get<double>(fault.value)));
    return lose(id, "killed by signal 9", Cause::kFault, false);
  }
  if (fault.way == Way::kDeactivate) return void(change(id, Transition::kDeactivate));
  if (fault.way == Way::kStop && part.is_running()) {
    part.process = ProcessState::kStopped;
    tell(ProcessSeen{id, ProcessState::kStopped, part.pid, "", Cause::kFault});
  }
  if (fault.parameter == "max_speed") set_parameter(id, fault.parameter, fault.value);
  if (fault.parameter != "fault" || !part.can_answer()) return;
  part.fault = std::get<std::string>(fault.value);
  if (part.fault == "crash") lose(id, "exit code 1", Cause::kFault, false);
  if (part.fault != "hang") return;
  part.answers = false;
  after(kFirstProbe, [this, id, pid = part.pid] { probe(id, pid); });
}

bool RoverModel::is_over(const Fault& fault) const {
  if (fault.name == "kidnapped") return pose_error_ < kLostAt;
  if (fault.way == Way::kStray) return !strays_.contains(fault.process);
  if (fault.parameter == "lidar_plugged") return is_plugged_;
  if (fault.parameter == "lidar_flaps") return flaps_since_ == kNever;
  if (fault.parameter == "battery") return charge_ > std::get<double>(fault.value);
  const Part& part = parts_[ids_.at(fault.cause).index];
  if (fault.way == Way::kDeactivate) return works(part);
  if (!part.is_running() || !part.is_in_graph) return false;
  if (fault.parameter == "fault") return part.fault != std::get<std::string>(fault.value);
  const Value* value = part.parameter(fault.parameter);
  return value == nullptr || *value != fault.value;
}

Measurements RoverModel::measure() const {
  Measurements result{.goals_reached = trip_.reached(), .goals_failed = trip_.failed()};
  result.stood_s = stood_s_;
  result.standing_s = seconds(now_ - moved_);
  result.pose_error_m = pose_error_;
  const auto broken = std::ranges::find_if(
      parts_, [this](const Part& part) { return part.is_server && !works(part); });
  result.complain(broken == parts_.end() ? "" : broken->name);
  return result;
}

// ---- requests

void RoverModel::reply(CommandId command, Outcome outcome, decltype(Reply::value) value) {
  if (open_.erase(command) > 0) tell(Reply{command, outcome, std::move(value), ""});
}

void RoverModel::execute(const Command& command) {
  open_.insert(command.id);
  const ComponentId id = command.component;
  if (std::holds_alternative<StopProcess>(command.what)) return stop(command);
  if (std::holds_alternative<StartProcess>(command.what)) {
    return after(kAnswer, [this, id, number = command.id] {
      if (parts_[id.index].is_gone() && !rules_[id].is_respawned) start(id);
      reply(number, Outcome::kDone, Value(std::int64_t{parts_[id.index].pid}));
    });
  }
  after(command.timeout, [this, number = command.id] { reply(number, Outcome::kTimedOut); });
  const bool changes = std::holds_alternative<ChangeLifecycle>(command.what);
  after(changes ? kTransition : kAnswer, [this, command] {
    const Part& part = parts_[command.component.index];
    if (!part.is_in_graph) return reply(command.id, Outcome::kUnreachable);
    if (part.can_answer()) serve(command);
  });
}

void RoverModel::stop(const Command& command) {
  const ComponentId id = command.component;
  const auto& request = std::get<StopProcess>(command.what);
  const Part& part = parts_[id.index];
  const bool is_meant = request.pid == 0 || request.pid == part.pid;
  if (!is_meant || part.is_gone())
    return after(kAnswer, [this, number = command.id] { reply(number, Outcome::kDone); });
  if (is_healthy(id) && on_healthy_taken_down) on_healthy_taken_down(id);
  const bool hangs = !part.can_answer();
  const Duration takes = hangs && !request.hangs && part.is_running() ? kEscalates : kEnds;
  after(takes, [this, id, hangs, number = command.id, pid = part.pid] {
    if (parts_[id.index].pid == pid) lose(id, "stopped", Cause::kWish, !hangs);
    reply(number, Outcome::kDone);
  });
}

void RoverModel::set_parameter(ComponentId id, const std::string& name, const Value& value) {
  if (!parts_[id.index].set_parameter(name, value)) return;
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    if (rules_.parameters[p].component == id && rules_.parameters[p].name == name)
      tell(ParameterRead{ParameterId(p), value});
  }
}

void RoverModel::serve(const Command& command) {
  const ComponentId id = command.component;
  Part& part = parts_[id.index];
  const auto reply_if = [&](bool is_done) {
    reply(command.id, is_done ? Outcome::kDone : Outcome::kRefused);
  };
  if (const auto* lifecycle = std::get_if<ChangeLifecycle>(&command.what)) {
    const bool takes_down = lifecycle->transition == Transition::kDeactivate;
    if (takes_down && is_healthy(id) && on_healthy_taken_down) on_healthy_taken_down(id);
    return reply_if(change(id, lifecycle->transition));
  }
  if (const auto* set = std::get_if<SetParameter>(&command.what)) {
    const bool is_possible = part.parameter(set->name) != nullptr;
    set_parameter(id, set->name, set->value);
    return reply_if(is_possible);
  }
  if (const auto* routine = std::get_if<CallService>(&command.what)) return call(command, *routine);
  simulation::Answer answer = part.answer(command.what);
  reply(command.id, answer.outcome, std::move(answer.value));
}

void RoverModel::call(const Command& command, const CallService& call) {
  const auto manager = managers_.find(command.component);
  if (manager != managers_.end()) {
    return manager->second->ask(0, [this, number = command.id](bool is_done) {
      reply(number, is_done ? Outcome::kDone : Outcome::kRefused);
    });
  }
  const bool is_known = call.service == "/reinitialize_global_localization";
  looks_everywhere_ = looks_everywhere_ || is_known;
  reply(command.id, is_known ? Outcome::kDone : Outcome::kUnreachable);
}

}  // namespace culprit::rover::model
