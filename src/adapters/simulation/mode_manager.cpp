#include "simulation/mode_manager.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit::simulation {
namespace {

LifecycleState state_of(const Node& node) {
  switch (node.lifecycle()) {
    case Lifecycle::kUnconfigured:
      return LifecycleState::kUnconfigured;
    case Lifecycle::kInactive:
      return LifecycleState::kInactive;
    case Lifecycle::kActive:
      return LifecycleState::kActive;
    case Lifecycle::kFinalized:
      return LifecycleState::kFinalized;
    case Lifecycle::kTransition:
    case Lifecycle::kUnknown:
      break;
  }
  return LifecycleState::kUnknown;
}

}  // namespace

ModeManager::ModeManager(World& world, std::string name, modes::Model model, NodeTraits traits)
    : Node(world, std::move(name), traits), model_(std::move(model)), inference_(model_) {
  for (const modes::Entity& entity : model_.entities) {
    if (!entity.is_system) continue;
    CULPRIT_ASSERT(
        std::none_of(entity.parts.begin(), entity.parts.end(),
                     [&](const std::string& part) { return model_.find(part)->is_system; }));
    world.systems_.emplace(entity.name, this);
  }
  world.watch(*this);
}

ModeManager::~ModeManager() {
  world().unwatch(*this);
  for (const modes::Entity& entity : model_.entities) world().systems_.erase(entity.name);
}

void ModeManager::on_start() {
  inference_.emplace(model_);
  for (const modes::Entity& entity : model_.entities)
    if (!entity.is_system) ask(entity.name, [this](Node& part) { hear_all_of(part); });
}

// ---- requests

bool ModeManager::change_mode(const std::string& system, const std::string& mode) {
  const modes::Entity* found = model_.find(system);
  CULPRIT_ASSERT(found != nullptr);
  const modes::Entity& known = *found;
  const modes::Mode* wanted = known.find(mode);
  if (wanted == nullptr) return false;
  if (mode_of(system) == mode) return true;
  inference_->set_target(system, {true, mode});
  for (const std::string& part : known.parts) aim(*model_.find(part), wanted->parts.at(part));
  inference_->infer();
  return true;
}

void ModeManager::aim(const modes::Entity& node, const modes::Target& target) {
  inference_->set_target(node.name, target);
  if (!target.is_active) {
    ask(node.name, [](Node& part) { part.change(Transition::kDeactivate); });
    return;
  }
  // The state first, then the parameters. Activating an active node fails, and that does no harm.
  ask(node.name, [parameters = node.find(target.mode)->parameters](Node& part) {
    part.change(Transition::kActivate);
    part.post([&part, parameters] {
      for (const auto& [name, value] : parameters) part.set_parameter(name, value);
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

std::string ModeManager::mode_of(const std::string& system) const {
  const std::string& mode = inference_->actual(system).mode;
  return mode.empty() ? kUnknownMode : mode;
}

// A new process declares its parameters, and that is announced as well.
void ModeManager::on_node(const Node& node, bool is_there) {
  if (is_there) hear_all_of(node);
}

void ModeManager::on_lifecycle(const Node& node) {
  hear(node.name(), [name = node.name(), state = state_of(node)](modes::Inference& inference) {
    inference.heard_state(name, state);
  });
}

void ModeManager::on_parameter(const Node& node, const std::string& name, const Value& value) {
  hear(node.name(), [node = node.name(), name, value](modes::Inference& inference) {
    inference.heard_parameter(node, name, value);
  });
}

void ModeManager::hear_all_of(const Node& node) {
  hear(node.name(), [name = node.name(), state = state_of(node),
                     all = node.parameters()](modes::Inference& inference) {
    inference.lost(name);
    inference.heard_state(name, state);
    for (const auto& [parameter, value] : all) inference.heard_parameter(name, parameter, value);
  });
}

// News come to the executor like everything else: one that hangs receives none.
void ModeManager::hear(const std::string& node, std::function<void(modes::Inference&)> news) {
  if (model_.find(node) == nullptr) return;
  post([this, news = std::move(news)] {
    news(*inference_);
    inference_->infer();
  });
}

}  // namespace culprit::simulation
