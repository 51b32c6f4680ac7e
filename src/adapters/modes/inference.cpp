#include "modes/inference.h"

#include <algorithm>

namespace culprit::modes {

void Inference::heard_state(const std::string& node, LifecycleState state) {
  if (model_.find(node) != nullptr) heard_[node].state = state;
}

void Inference::heard_parameter(const std::string& node, const std::string& parameter,
                                const Value& value) {
  const Entity* entity = model_.find(node);
  if (entity != nullptr && entity->modes.front().parameters.contains(parameter))
    heard_[node].parameters[parameter] = value;
}

void Inference::lost(const std::string& node) { heard_.erase(node); }

void Inference::set_target(const std::string& entity, const Target& target) {
  targets_[entity] = target;
}

std::optional<Target> Inference::target(const std::string& entity) const {
  const auto known = targets_.find(entity);
  return known == targets_.end() ? std::nullopt : std::optional(known->second);
}

std::size_t Inference::index_of(const std::string& entity) const {
  return static_cast<std::size_t>(model_.find(entity) - model_.entities.data());
}

const Actual& Inference::actual(const std::string& entity) const {
  return actual_[index_of(entity)];
}

bool is_at(const Actual& actual, const Target& target) {
  const LifecycleState state = actual.state;
  if (!target.is_active)
    return state == LifecycleState::kInactive || state == LifecycleState::kUnconfigured;
  return state == LifecycleState::kActive && actual.mode == target.mode;
}

bool Inference::is_at(const std::string& entity, const Target& target) const {
  return modes::is_at(actual(entity), target);
}

std::vector<Inference::Change> Inference::infer() {
  std::vector<Change> changes;
  for (std::size_t i = 0; i < model_.entities.size(); ++i) {
    const Entity& entity = model_.entities[i];
    Actual now = entity.is_system ? infer_system(entity) : infer_node(entity);
    if (now == actual_[i]) continue;
    changes.push_back({&entity, actual_[i], now});
    actual_[i] = std::move(now);
  }
  return changes;
}

bool Inference::fits(const Mode& mode, const Heard& heard) const {
  return std::all_of(mode.parameters.begin(), mode.parameters.end(), [&](const auto& wanted) {
    const auto value = heard.parameters.find(wanted.first);
    return value != heard.parameters.end() && value->second == wanted.second;
  });
}

Actual Inference::infer_node(const Entity& node) const {
  const auto known = heard_.find(node.name);
  if (known == heard_.end()) return {};
  const Heard& heard = known->second;
  if (node.modes.size() == 1) return {heard.state, node.modes.front().name};
  const auto target = targets_.find(node.name);
  if (target != targets_.end()) {
    const Mode* wanted = node.find(target->second.mode);
    if (wanted != nullptr && fits(*wanted, heard)) return {heard.state, wanted->name};
  }
  for (const Mode& mode : node.modes)
    if (fits(mode, heard)) return {heard.state, mode.name};
  return {heard.state, ""};
}

bool Inference::fits(const Mode& mode) const {
  return std::all_of(mode.parts.begin(), mode.parts.end(),
                     [&](const auto& part) { return is_at(part.first, part.second); });
}

Actual Inference::infer_system(const Entity& system) const {
  const auto is_in = [&](LifecycleState state) {
    return [this, state](const std::string& part) { return actual(part).state == state; };
  };
  if (std::any_of(system.parts.begin(), system.parts.end(),
                  is_in(LifecycleState::kErrorProcessing)))
    return {LifecycleState::kErrorProcessing, ""};
  const bool are_inactive =
      std::all_of(system.parts.begin(), system.parts.end(), [&](const std::string& part) {
        return is_at(part, Target{false, ""});
      });
  const auto target = targets_.find(system.name);
  if (target != targets_.end() && !target->second.is_active)
    return {are_inactive ? LifecycleState::kInactive : LifecycleState::kDeactivating, ""};

  if (target != targets_.end() && fits(*system.find(target->second.mode)))
    return {LifecycleState::kActive, target->second.mode};
  const auto fitting = std::find_if(system.modes.begin(), system.modes.end(),
                                    [&](const Mode& mode) { return fits(mode); });
  const std::string mode = fitting == system.modes.end() ? "" : fitting->name;
  if (target != targets_.end()) return {LifecycleState::kActivating, mode};
  if (are_inactive) return {LifecycleState::kInactive, mode};
  return {mode.empty() ? LifecycleState::kUnknown : LifecycleState::kActive, mode};
}

}  // namespace culprit::modes
