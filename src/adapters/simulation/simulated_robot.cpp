#include "simulation/simulated_robot.h"

#include "simulation/mode_manager.h"
#include "simulation/node.h"
#include "simulation/topic.h"

namespace culprit::simulation {

SimulatedRobot::SimulatedRobot(const RuleSet& rules, World& world)
    : rules_(rules), world_(world), binding_(rules) {
  index_rules();
  world_.watch(*this);
  for (const Node* node : world_.nodes()) {
    if (node->process() != ProcessState::kGone) on_process(*node, "");
    if (!node->is_in_graph()) continue;
    on_node(*node, true);
    node->for_each_endpoint(
        [&](EndpointKind kind, const std::string& name) { on_endpoint(*node, kind, name, true); });
    on_lifecycle(*node);
  }
}

SimulatedRobot::~SimulatedRobot() { world_.unwatch(*this); }

void SimulatedRobot::index_rules() {
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    if (rules_.topics[t].publisher) continue;  // its messages do not name their publisher
    topics_.emplace(rules_.topics[t].name, TopicId(t));
    if (TopicBase* topic = world_.topic(rules_.topics[t].name)) topic->set_watched(true);
  }
  for (std::size_t s = 0; s < rules_.signals.size(); ++s) {
    const Signal& signal = rules_.signals[s];
    if (const auto* source = std::get_if<DiagnosticKey>(&signal.source)) {
      const bool is_any = source->status == "*";
      signals_[is_any ? source->key : source->status + "\n" + source->key].push_back(SignalId(s));
    } else if (const auto* field = std::get_if<TopicField>(&signal.source)) {
      const std::string& topic = rules_[field->topic].name;
      signals_[topic + "\n" + field->field].push_back(SignalId(s));
      if (TopicBase* known = world_.topic(topic)) {
        known->set_watched(true);
        known->watch_field(field->field);
      }
    } else if (std::holds_alternative<LookedUp>(signal.source)) {
      signals_[signal.name].push_back(SignalId(s));
    }
  }
}

void SimulatedRobot::observe(Time until, std::vector<Observation>& observations) {
  while (inbox_.empty() && world_.step(until)) continue;
  if (inbox_.empty() && until != kNever) world_.set_time(until);
  std::move(inbox_.begin(), inbox_.end(), std::back_inserter(observations));
  inbox_.clear();
}

// ---- what it sees

std::optional<ComponentId> SimulatedRobot::component_of(const Node& node) {
  const auto known = components_.find(&node);
  if (known != components_.end()) return known->second;
  const auto component = binding_.bind(node.name());
  if (component) components_.emplace(&node, *component);
  return component;
}

// The systems whose modes `manager` serves come and go with it.
void SimulatedRobot::tell_systems(const Node& manager, bool is_there) {
  for (const auto& [system, server] : world_.systems()) {
    if (server != &manager) continue;
    if (!is_there) {
      tell(NodeVanished{system});
      continue;
    }
    (void)binding_.bind(system);
    tell(NodeAppeared{system, manager.pid()});
  }
}

void SimulatedRobot::on_node(const Node& node, bool is_there) {
  tell_systems(node, is_there);
  if (!is_there) return tell(NodeVanished{node.name()});
  tell(NodeAppeared{node.name(), node.pid()});
  const auto component = component_of(node);
  if (!component) return;
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    const Parameter& parameter = rules_.parameters[p];
    const Value* value = node.parameter(parameter.name);
    if (parameter.component == *component && value) tell(ParameterRead{ParameterId(p), *value});
  }
}

void SimulatedRobot::on_endpoint(const Node& node, EndpointKind kind, const std::string& name,
                                 bool is_there) {
  if (is_there) {
    tell(EndpointAppeared{node.name(), kind, name});
  } else {
    tell(EndpointVanished{node.name(), kind, name});
  }
}

void SimulatedRobot::on_sample(const TopicBase& topic) {
  const auto known = topics_.find(topic.name());
  if (known != topics_.end()) tell(SampleArrived{known->second});
}

void SimulatedRobot::on_diagnostic(std::string_view status, std::string_view key,
                                   const Value& value) {
  const std::string of_status(status);
  const std::string of_key(key);
  for (const std::string& name : {of_status + "\n" + of_key, of_status + "_" + of_key, of_key})
    tell_signals(name, value);
}

void SimulatedRobot::on_field(const TopicBase& topic, const std::string& field,
                              const Value& value) {
  tell_signals(topic.name() + "\n" + field, value);
}

void SimulatedRobot::tell_signals(const std::string& name, const Value& value) {
  const auto known = signals_.find(name);
  if (known == signals_.end()) return;
  for (const SignalId signal : known->second) tell(SignalRead{signal, value});
}

void SimulatedRobot::on_level(std::string_view status, std::uint8_t level) {
  for (std::size_t d = 0; d < rules_.diagnostics.size(); ++d) {
    if (rules_.diagnostics[d].name == status) tell(DiagnosticRead{DiagnosticId(d), level});
  }
}

void SimulatedRobot::on_parameter(const Node& node, const std::string& name, const Value& value) {
  const auto component = component_of(node);
  if (!component) return;
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    const Parameter& parameter = rules_.parameters[p];
    if (parameter.component == *component && parameter.name == name)
      tell(ParameterRead{ParameterId(p), value});
  }
}

void SimulatedRobot::on_lifecycle(const Node& node) {
  if (const auto component = component_of(node)) tell(LifecycleRead{*component, node.lifecycle()});
}

void SimulatedRobot::on_process(const Node& node, const std::string& remark) {
  const auto tell_component = [&](std::optional<ComponentId> component) {
    if (component) tell(ProcessSeen{*component, node.process(), node.pid(), remark});
  };
  tell_component(component_of(node));
  for (const auto& [system, server] : world_.systems()) {
    if (server == &node) tell_component(binding_.bind(system));
  }
}

// ---- what it is asked

Node* SimulatedRobot::node_of(ComponentId component) const {
  return world_.node(binding_.node_of(component));
}

// The node that serves the request: the component's node, or, for modes, the mode manager.
Node* SimulatedRobot::server_of(const Command& command) const {
  const bool is_about_modes = std::holds_alternative<ChangeMode>(command.what) ||
                              std::holds_alternative<ReadMode>(command.what);
  if (!is_about_modes) return node_of(command.component);
  ModeManager* manager = world_.modes_of(binding_.node_of(command.component));
  return manager != nullptr ? manager : node_of(command.component);
}

void SimulatedRobot::execute(const Command& command) {
  open_.insert(command.id);
  Node* node = server_of(command);
  if (node == nullptr) {
    world_.after({}, [this, id = command.id] { reply(id, Outcome::kUnreachable); });
  } else if (std::holds_alternative<StopProcess>(command.what)) {
    node->terminate([this, id = command.id] { reply(id, Outcome::kDone); });
  } else if (std::holds_alternative<StartProcess>(command.what)) {
    node->launch();
    reply(command.id, Outcome::kDone, Value(std::int64_t{node->pid()}));
  } else {
    request(command, *node);
  }
}

// A request to a node that is not in the graph reaches none; one without an answer ends with the
// time limit.
void SimulatedRobot::request(const Command& command, Node& node) {
  world_.after(command.timeout, [this, id = command.id] { reply(id, Outcome::kTimedOut); });
  if (!node.is_in_graph()) {
    world_.after({}, [this, id = command.id] { reply(id, Outcome::kUnreachable); });
    return;
  }
  if (node.random().chance(node.traits().deafness)) return;
  world_.after(node.traits().service.draw(node.random()), [this, command, &node] {
    node.post([this, command, &node] { serve(command, node); });
  });
}

void SimulatedRobot::serve(const Command& command, Node& node) {
  const auto done_if = [&](bool is_done) {
    answer(command, node, is_done ? Outcome::kDone : Outcome::kRefused);
  };
  if (const auto* change = std::get_if<ChangeLifecycle>(&command.what)) {
    done_if(node.change(change->transition));
  } else if (const auto* set = std::get_if<SetParameter>(&command.what)) {
    done_if(node.set_parameter(set->name, set->value));
  } else if (const auto* call = std::get_if<CallService>(&command.what)) {
    done_if(node.call(call->service));
  } else if (std::holds_alternative<ReadLifecycle>(command.what) ||
             std::holds_alternative<ReadParameter>(command.what) ||
             std::holds_alternative<Probe>(command.what)) {
    Answer read = node.read(command.what);
    answer(command, node, read.outcome, std::move(read.value), std::move(read.text));
  } else {
    serve_modes(command, node);
  }
}

void SimulatedRobot::serve_modes(const Command& command, Node& node) {
  const std::string& system = binding_.node_of(command.component);
  ModeManager* manager = world_.modes_of(system);
  if (manager == nullptr) {
    answer(command, node, Outcome::kRefused, {}, "the node has no modes");
  } else if (const auto* change = std::get_if<ChangeMode>(&command.what)) {
    const bool is_accepted = manager->change_mode(system, change->mode);
    answer(command, node, is_accepted ? Outcome::kDone : Outcome::kRefused, {},
           is_accepted ? "" : "it has no mode " + change->mode);
  } else {
    answer(command, node, Outcome::kDone, Value(manager->mode_of(system)));
  }
}

// The answer leaves when the callback is over.
void SimulatedRobot::answer(const Command& command, Node& node, Outcome outcome,
                            decltype(Reply::value) value, std::string text) {
  const Time at = later(node.free_at(), node.traits().service.draw(node.random()));
  world_.at(at, [this, id = command.id, outcome, value = std::move(value), text = std::move(text)] {
    reply(id, outcome, value, text);
  });
}

void SimulatedRobot::reply(CommandId command, Outcome outcome, decltype(Reply::value) value,
                           std::string text) {
  if (open_.erase(command) > 0) tell(Reply{command, outcome, std::move(value), std::move(text)});
}

}  // namespace culprit::simulation
