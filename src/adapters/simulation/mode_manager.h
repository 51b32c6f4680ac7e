// The mode manager of system_modes: changes the modes of systems, and infers in which they are.
//
// - An accepted request is not yet done: the parts get requests, each in its own time, and the
//   manager does not wait for their answers. It does not request a mode that the system has already.
// - The mode of a system is inferred from its parts' announcements, as in the live manager
//   (modes/inference.h).
// - It is a node like others: it has one executor thread, and it can be killed and hang. A new
//   process asks the parts for their state, for it has received nothing.
// Systems of systems and rules are not modelled, nor requests that are about a plain node.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "modes/inference.h"
#include "simulation/node.h"

namespace culprit::simulation {

class ModeManager : public Node, private Watcher {
 public:
  // `world` must outlive it.
  // @pre the parts of the model's systems are nodes.
  ModeManager(World& world, std::string name, modes::Model model, NodeTraits traits);
  ~ModeManager() override;

  // Gives whether the request is accepted: whether there is such a mode.
  // @pre the model has the system; so too of the next.
  bool change_mode(const std::string& system, const std::string& mode);
  // The inferred mode.
  std::string mode_of(const std::string& system) const;

 private:
  void on_start() override;
  void on_node(const Node& node, bool is_there) override;
  void on_lifecycle(const Node& node) override;
  void on_parameter(const Node& node, const std::string& name, const Value& value) override;

  void aim(const modes::Entity& node, const modes::Target& target);
  void hear(const std::string& node, std::function<void(modes::Inference&)> news);
  void hear_all_of(const Node& node);
  // Has the node's executor do `work`, after the way there.
  void ask(const std::string& node, std::function<void(Node&)> work);

  const modes::Model model_;
  std::optional<modes::Inference> inference_;  // of this process
};

}  // namespace culprit::simulation
