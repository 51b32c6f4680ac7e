#include "mode_manager/mode_manager.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "robot/command.h"

namespace culprit::mode_manager {
namespace {

using ros2::TransitionId;
using ros2::msg::TransitionEvent;

std::uint64_t now_ns() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

std::string mode_label(const modes::Actual& actual) {
  return actual.mode.empty() ? kUnknownMode : actual.mode;
}

TransitionEvent transition(LifecycleState from, LifecycleState to) {
  TransitionEvent event;
  event.timestamp = now_ns();
  event.start_state = ros2::to_message(from);
  event.goal_state = ros2::to_message(to);
  return event;
}

LifecycleState state_of(const modes::Target& target) {
  return target.is_active ? LifecycleState::kActive : LifecycleState::kInactive;
}

}  // namespace

Expected<std::unique_ptr<ModeManager>> ModeManager::create(ros2::Executor& executor,
                                                           const modes::Model& model,
                                                           Options options) {
  std::unique_ptr<ModeManager> manager(new ModeManager(executor, model, std::move(options)));
  if (auto opened = manager->open(executor); !opened) return Error{opened.error()};
  return manager;
}

ModeManager::ModeManager(ros2::Executor& executor, const modes::Model& model, Options options)
    : model_(model), options_(std::move(options)), inference_(model), tasks_(executor) {}

ModeManager::~ModeManager() { tasks_.close(); }

Expected<void> ModeManager::open(ros2::Executor& executor) {
  ros2::Graph::Options graph;
  graph.listener = [this](const ros2::GraphChange& change) { on_graph(change); };
  auto context = ros2::Context::create(executor, options_.participant, std::move(graph));
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = ros2::Node::create(*context_, {"/", "__mode_manager"});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  ros2::msg::ParameterDescriptor read_only;
  read_only.read_only = true;
  if (auto declared =
          node_->parameters().declare("modelfile", Value(options_.model_file), read_only);
      !declared)
    return declared;
  for (const modes::Entity& entity : model_.entities) {
    if (auto opened = open_voice(entity); !opened) return opened;
    if (!entity.is_system)
      if (auto opened = open_link(entity); !opened) return opened;
    if (auto opened = open_services(entity); !opened) return opened;
  }
  return watch_parameters();
}

Expected<void> ModeManager::open_voice(const modes::Entity& entity) {
  constexpr rtps::Qos kLast{.depth = 1};
  auto modes = node_->create_publisher<msg::ModeEvent>(entity.name + "/mode_event", kLast);
  if (!modes) return Error{modes.error()};
  auto mode_requests =
      node_->create_publisher<msg::ModeEvent>(entity.name + "/mode_request_info", kLast);
  if (!mode_requests) return Error{mode_requests.error()};
  auto requests =
      node_->create_publisher<TransitionEvent>(entity.name + "/transition_request_info", kLast);
  if (!requests) return Error{requests.error()};
  Voice voice{{}, std::move(*modes), std::move(*mode_requests), std::move(*requests)};
  if (entity.is_system) {
    auto transitions =
        node_->create_publisher<TransitionEvent>(entity.name + "/transition_event", kLast);
    if (!transitions) return Error{transitions.error()};
    voice.transitions.emplace(std::move(*transitions));
  }
  voices_.emplace(entity.name, std::move(voice));
  return {};
}

Expected<void> ModeManager::open_link(const modes::Entity& node) {
  auto link = NodeLink::create(*node_, node,
                               {[this, &node](LifecycleState state) {
                                  inference_.heard_state(node.name, state);
                                  update();
                                },
                                [this, &node](const std::string& parameter, const Value& value) {
                                  inference_.heard_parameter(node.name, parameter, value);
                                  update();
                                },
                                [this](const std::string& text) { trouble(text); }});
  if (!link) return Error{link.error()};
  links_.emplace(node.name, std::move(*link));
  return {};
}

template <class Service, class Handler>
Expected<void> ModeManager::serve(const std::string& name, Handler handler) {
  auto server = node_->create_service<Service>(name, std::move(handler));
  if (!server) return Error{server.error()};
  services_.push_back(std::move(*server));
  return {};
}

// change_mode comes last: a client that discovers it can read the mode as well.
Expected<void> ModeManager::open_services(const modes::Entity& entity) {
  if (entity.is_system) {
    for (auto& opened :
         {serve<ros2::srv::ChangeState>(
              entity.name + "/change_state",
              [this, &entity](const ros2::srv::ChangeState::Request& request) {
                return ros2::srv::ChangeState::Response{change_state(entity, request.transition)};
              }),
          serve<ros2::srv::GetState>(entity.name + "/get_state",
                                     [this, &entity](const ros2::srv::GetState::Request&) {
                                       return ros2::srv::GetState::Response{
                                           ros2::to_message(inference_.actual(entity.name).state)};
                                     }),
          serve<ros2::srv::GetAvailableStates>(entity.name + "/get_available_states",
                                               [](const ros2::srv::GetAvailableStates::Request&) {
                                                 return ros2::srv::GetAvailableStates::Response{
                                                     {ros2::to_message(LifecycleState::kInactive),
                                                      ros2::to_message(LifecycleState::kActive)}};
                                               })}) {
      if (!opened) return opened;
    }
  }
  for (auto& opened :
       {serve<ros2::srv::GetMode>(entity.name + "/get_mode",
                                  [this, &entity](const ros2::srv::GetMode::Request&) {
                                    return ros2::srv::GetMode::Response{
                                        mode_label(inference_.actual(entity.name))};
                                  }),
        serve<srv::GetAvailableModes>(entity.name + "/get_available_modes",
                                      [&entity](const srv::GetAvailableModes::Request&) {
                                        srv::GetAvailableModes::Response response;
                                        for (const modes::Mode& mode : entity.modes)
                                          response.available_modes.push_back(mode.name);
                                        std::sort(response.available_modes.begin(),
                                                  response.available_modes.end());
                                        return response;
                                      }),
        serve<ros2::srv::ChangeMode>(
            entity.name + "/change_mode",
            [this, &entity](const ros2::srv::ChangeMode::Request& request) {
              return ros2::srv::ChangeMode::Response{change_mode(entity, request.mode_name)};
            })}) {
    if (!opened) return opened;
  }
  return {};
}

Expected<void> ModeManager::watch_parameters() {
  auto events = node_->create_subscription<ros2::msg::ParameterEvent>(
      "/parameter_events", rtps::qos::kParameterEvents,
      [this](const ros2::msg::ParameterEvent& event) {
        const auto link = links_.find(event.node);
        if (link == links_.end()) return;
        for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
          for (const ros2::msg::Parameter& changed : *changes)
            if (const auto value = ros2::to_value(changed.value))
              link->second->announced(changed.name, *value);
        }
      });
  if (!events) return Error{events.error()};
  parameter_events_ = std::move(*events);
  return {};
}

// The listener must not call back into the graph, and the nodes' links may not exist yet.
void ModeManager::on_graph(const ros2::GraphChange& change) {
  if (const auto* joined = std::get_if<ros2::NodeJoined>(&change)) {
    tasks_.post([this, name = joined->node.name] {
      const auto link = links_.find(name);
      if (link != links_.end()) link->second->read();
    });
  } else if (const auto* left = std::get_if<ros2::NodeLeft>(&change)) {
    tasks_.post([this, name = left->node] {
      inference_.lost(name);
      update();
    });
  }
}

// ---- what is asked

bool ModeManager::change_mode(const modes::Entity& entity, const std::string& mode) {
  if (entity.find(mode) == nullptr) {
    trouble(entity.name + " was asked for mode '" + printable(mode) + "', which it does not have");
    return false;
  }
  aim(entity, {true, mode});
  return true;
}

bool ModeManager::change_state(const modes::Entity& system, const ros2::msg::Transition& asked) {
  const auto all = ros2::lifecycle_transitions();
  const auto wanted = std::find_if(all.begin(), all.end(), [&](const auto& known) {
    return asked.label.empty() ? known.id == asked.id : known.label == asked.label;
  });
  if (wanted == all.end()) return false;
  switch (static_cast<TransitionId>(wanted->id)) {
    case TransitionId::kActivate:
      aim(system, {true, modes::kDefaultMode});
      return true;
    case TransitionId::kDeactivate:
      aim(system, {false, ""});
      return true;
    case TransitionId::kConfigure:
    case TransitionId::kCleanup:
      for (const std::string& part : system.parts)
        if (const auto link = links_.find(part); link != links_.end())
          link->second->change(static_cast<TransitionId>(wanted->id));
      return true;
    default:
      return false;
  }
}

// Systems come after their parts in the model, so one walk back over it reaches them all.
void ModeManager::aim(const modes::Entity& entity, const modes::Target& target) {
  std::map<std::string, modes::Target> wanted{{entity.name, target}};
  const auto first = model_.entities.begin() + (&entity - model_.entities.data());
  for (auto each = std::make_reverse_iterator(first + 1); each != model_.entities.rend(); ++each) {
    const auto own = wanted.find(each->name);
    if (own == wanted.end()) continue;
    const modes::Target aimed = own->second;
    announce(*each, aimed);
    inference_.set_target(each->name, aimed);
    watch_overdue(*each, aimed);
    if (!each->is_system) {
      steer(*each, aimed);
      continue;
    }
    for (const std::string& part : each->parts)
      wanted[part] =
          aimed.is_active ? each->find(aimed.mode)->parts.at(part) : modes::Target{false, ""};
  }
  update();
}

// The state first, then the parameters, as the original does.
void ModeManager::steer(const modes::Entity& node, const modes::Target& target) {
  NodeLink& link = *links_.at(node.name);
  const LifecycleState state = inference_.actual(node.name).state;
  if (!target.is_active) {
    if (state != LifecycleState::kInactive) link.change(TransitionId::kDeactivate);
    return;
  }
  if (state != LifecycleState::kActive) link.change(TransitionId::kActivate);
  link.set(node.find(target.mode)->parameters);
}

void ModeManager::announce(const modes::Entity& entity, const modes::Target& target) {
  const modes::Actual& now = inference_.actual(entity.name);
  Voice& voice = voices_.at(entity.name);
  if (target.is_active) voice.mode_requests.publish({now_ns(), {mode_label(now)}, {target.mode}});
  voice.transition_requests.publish(transition(now.state, state_of(target)));
}

void ModeManager::watch_overdue(const modes::Entity& entity, const modes::Target& target) {
  tasks_.post_at(ros2::Executor::Clock::now() + kOverdue, [this, &entity, target] {
    if (inference_.target(entity.name) != target || inference_.is_at(entity.name, target)) return;
    const modes::Actual& now = inference_.actual(entity.name);
    trouble(entity.name + " was requested to be " + to_string(target) + " but is " +
            std::string(ros2::label_of(now.state)) + ", mode " + mode_label(now));
  });
}

// ---- what came of it

void ModeManager::update() {
  const auto changes = inference_.infer();
  for (const modes::Inference::Change& change : changes) publish(change);
  apply_rules(changes);
}

void ModeManager::publish(const modes::Inference::Change& change) {
  Voice& voice = voices_.at(change.entity->name);
  if (voice.transitions && change.before.state != change.now.state)
    voice.transitions->publish(transition(change.before.state, change.now.state));
  if (change.before.mode != change.now.mode)
    voice.modes.publish({now_ns(), {mode_label(change.before)}, {mode_label(change.now)}});
  if (options_.on_change) options_.on_change(change);
}

// Only where a part came to be what a rule is about: one that is not on its way yet is no
// deviation. Not at once: a rule's own target is a change of its own.
void ModeManager::apply_rules(const std::vector<modes::Inference::Change>& changes) {
  const auto came_to = [&](const std::string& part, const modes::Target& wanted) {
    return std::any_of(changes.begin(), changes.end(), [&](const auto& change) {
      return change.entity->name == part && is_at(change.now, wanted) &&
             !is_at(change.before, wanted);
    });
  };
  for (const modes::Entity& system : model_.entities) {
    const auto target = inference_.target(system.name);
    if (!target || inference_.is_at(system.name, *target)) continue;
    const auto rule =
        std::find_if(system.rules.begin(), system.rules.end(), [&](const modes::Rule& each) {
          return each.if_target == *target && came_to(each.part, each.if_part);
        });
    if (rule == system.rules.end()) continue;
    trouble(system.name + ": rule " + rule->name + " aims at " + to_string(rule->new_target));
    tasks_.post([this, &system, aimed = rule->new_target] { aim(system, aimed); });
  }
}

void ModeManager::trouble(const std::string& text) {
  node_->log(ros2::Severity::kWarn, text);
  if (options_.on_trouble) options_.on_trouble(text);
}

}  // namespace culprit::mode_manager
