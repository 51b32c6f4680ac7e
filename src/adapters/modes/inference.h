// The state and mode of each system and node, inferred from the nodes' reports (system_modes,
// mode_inference.cpp).
//
// - A node is in its target mode if its parameters fit, or else in the first mode that they fit. A
//   node with one mode is in it whatever its parameters are: the original's examples give such
//   nodes a parameter for the form's sake that the node does not have.
// - A system is in its target if every part is. Otherwise it is activating (in the mode that its
//   parts fit, if they fit one) or deactivating.
// - A system without a target is in the first mode that its parts fit, or inactive if they all are.
//   The original reports "unknown" there, so that a manager that restarted knows nothing.
// - A part in error processing makes its system so.
//
// A pure data structure, fed with the events.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/lifecycle_state.h"
#include "modes/model.h"

namespace culprit::modes {

struct Actual {
  LifecycleState state = LifecycleState::kUnknown;
  std::string mode;  // empty: it fits none
  bool operator==(const Actual&) const = default;
};

// An unconfigured node counts as inactive.
bool is_at(const Actual& actual, const Target& target);

class Inference {
 public:
  // `model` must outlive the inference.
  explicit Inference(const Model& model) : model_(model), actual_(model.entities.size()) {}

  // Names that are not in the model are left out.
  void heard_state(const std::string& node, LifecycleState state);
  void heard_parameter(const std::string& node, const std::string& parameter, const Value& value);
  // Its process has exited.
  void lost(const std::string& node);
  void set_target(const std::string& entity, const Target& target);
  std::optional<Target> target(const std::string& entity) const;

  // The newest inferred state.
  const Actual& actual(const std::string& entity) const;
  bool is_at(const std::string& entity, const Target& target) const;

  struct Change {
    const Entity* entity;
    Actual before;
    Actual now;
  };
  // Infers the states again, and gives the changes.
  std::vector<Change> infer();

 private:
  struct Heard {
    LifecycleState state = LifecycleState::kUnknown;
    std::map<std::string, Value> parameters;
  };

  std::size_t index_of(const std::string& entity) const;
  Actual infer_node(const Entity& node) const;
  Actual infer_system(const Entity& system) const;
  bool fits(const Mode& mode, const Heard& heard) const;
  bool fits(const Mode& mode) const;

  const Model& model_;
  std::map<std::string, Heard> heard_;
  std::map<std::string, Target> targets_;
  std::vector<Actual> actual_;  // by entity
};

}  // namespace culprit::modes
