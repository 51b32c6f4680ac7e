#include "simulation/mode_manager.h"

#include <algorithm>

namespace culprit::simulation {

ModeManager::ModeManager(World& world, std::string name, std::vector<ModeSystem> systems,
                         NodeTraits traits)
    : Node(world, std::move(name), traits), systems_(std::move(systems)) {
  for (const ModeSystem& system : systems_) {
    world.systems_.emplace(system.name, this);
    for (const SystemMode& mode : system.modes) {
      for (const PartMode& part : mode.parts) heard_[part.node];
    }
  }
  world.watch(*this);
}

ModeManager::~ModeManager() {
  world().unwatch(*this);
  for (const ModeSystem& system : systems_) world().systems_.erase(system.name);
}

void ModeManager::on_start() {
  targets_.clear();
  for (auto& [name, heard] : heard_) {
    heard = {};
    ask(name, [this](Node& part) {
      hear(part.name(), [lifecycle = part.lifecycle(), all = part.parameters()](Heard& h) {
        h.lifecycle = lifecycle;
        h.parameters = all;
      });
    });
  }
}

// ---- requests

const ModeSystem& ModeManager::find(const std::string& system) const {
  return *std::find_if(systems_.begin(), systems_.end(),
                       [&](const ModeSystem& s) { return s.name == system; });
}

bool ModeManager::change_mode(const std::string& system, const std::string& mode) {
  const ModeSystem& known = find(system);
  const auto wanted = std::find_if(known.modes.begin(), known.modes.end(),
                                   [&](const SystemMode& m) { return m.name == mode; });
  if (wanted == known.modes.end()) return false;
  if (mode_of(system) == mode) return true;
  targets_[system] = mode;
  for (const PartMode& part : wanted->parts) command(part);
  return true;
}

void ModeManager::command(const PartMode& part) {
  if (!part.is_active) {
    ask(part.node, [](Node& node) { node.change(Transition::kDeactivate); });
    return;
  }
  // The state first, then the parameters. Activating what is active fails, and nobody minds.
  ask(part.node, [parameters = part.parameters](Node& node) {
    node.change(Transition::kActivate);
    node.post([&node, parameters] {
      for (const auto& [name, value] : parameters) node.set_parameter(name, value);
    });
  });
}

void ModeManager::ask(const std::string& node, std::function<void(Node&)> work) {
  Node* part = world().node(node);
  if (part == nullptr || !part->is_in_graph()) return;
  world().after(part->traits().service.draw(random()),
                [part, work = std::move(work)] { part->post([part, work] { work(*part); }); });
}

// ---- inference

bool ModeManager::fits(const SystemMode& mode) const {
  return std::all_of(mode.parts.begin(), mode.parts.end(), [&](const PartMode& part) {
    const Heard& heard = heard_.at(part.node);
    if (!part.is_active)
      return heard.lifecycle == Lifecycle::kInactive || heard.lifecycle == Lifecycle::kUnconfigured;
    return heard.lifecycle == Lifecycle::kActive &&
           std::all_of(part.parameters.begin(), part.parameters.end(), [&](const auto& wanted) {
             const auto value = heard.parameters.find(wanted.first);
             return value != heard.parameters.end() && value->second == wanted.second;
           });
  });
}

std::string ModeManager::mode_of(const std::string& system) const {
  const ModeSystem& known = find(system);
  const auto target = targets_.find(system);
  const SystemMode* first = nullptr;
  for (const SystemMode& mode : known.modes) {
    if (!fits(mode)) continue;
    if (target != targets_.end() && target->second == mode.name) return mode.name;
    if (first == nullptr) first = &mode;
  }
  return first == nullptr ? kUnknownMode : first->name;
}

// A new process declares its parameters, and that is announced as well.
void ModeManager::on_node(const Node& node, bool is_there) {
  if (!is_there || !is_part(node.name())) return;
  hear(node.name(), [lifecycle = node.lifecycle(), all = node.parameters()](Heard& h) {
    h.lifecycle = lifecycle;
    h.parameters = all;
  });
}

void ModeManager::on_lifecycle(const Node& node) {
  if (!is_part(node.name())) return;
  hear(node.name(), [lifecycle = node.lifecycle()](Heard& h) { h.lifecycle = lifecycle; });
}

void ModeManager::on_parameter(const Node& node, const std::string& name, const Value& value) {
  if (is_part(node.name()))
    hear(node.name(), [name, value](Heard& h) { h.parameters[name] = value; });
}

// News come to the executor like everything else: one that hangs hears nothing.
void ModeManager::hear(const std::string& node, std::function<void(Heard&)> news) {
  post([this, node, news = std::move(news)] { news(heard_.at(node)); });
}

}  // namespace culprit::simulation
