// The mode manager of a live robot: changes the modes of systems and nodes, and reports their
// modes. It offers what the mode_manager of system_modes offers, as the node /__mode_manager:
//
// - of each system: change_state, get_state, get_available_states, and transition_event;
// - of each system and node: change_mode, get_mode, get_available_modes, mode_event, and what was
//   asked for, on mode_request_info and transition_request_info.
//
// An accepted request is not yet done: the manager sends requests to the parts, and does not wait
// for their answers. It infers the result (modes/inference.h) from what the nodes announce, and
// publishes it when it changes. If an accepted request has no effect, it reports that after
// kOverdue.
//
// Other than the original it publishes at once, not once a second. It reads the nodes' states and
// parameters when it starts and when they do. It sends no activate request to a node that is
// active. It does not subscribe to the request topics of others, nor to modes that nodes publish
// themselves.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mode_manager/messages.h"
#include "mode_manager/node_link.h"
#include "modes/inference.h"
#include "ros2/context.h"
#include "ros2/services.h"

namespace culprit::mode_manager {

class ModeManager {
 public:
  static constexpr Duration kOverdue = std::chrono::seconds(10);

  struct Options {
    ros2::ParticipantOptions participant;
    std::string model_file;  // shown as a parameter
    std::function<void(const modes::Inference::Change&)>
        on_change;  // each on the executor's thread
    std::function<void(const std::string&)> on_trouble;
  };

  // The executor and the model outlive the manager. Errors: the domain cannot be joined, or a name
  // of the model cannot be one of ROS 2.
  static Expected<std::unique_ptr<ModeManager>> create(ros2::Executor& executor,
                                                       const modes::Model& model, Options options);
  ~ModeManager();

 private:
  // The publishers of one system or node.
  struct Voice {
    std::optional<ros2::Publisher<ros2::msg::TransitionEvent>> transitions;  // of a system
    ros2::Publisher<msg::ModeEvent> modes;
    ros2::Publisher<msg::ModeEvent> mode_requests;
    ros2::Publisher<ros2::msg::TransitionEvent> transition_requests;
  };

  ModeManager(ros2::Executor& executor, const modes::Model& model, Options options);
  Expected<void> open(ros2::Executor& executor);
  Expected<void> open_voice(const modes::Entity& entity);
  Expected<void> open_services(const modes::Entity& entity);
  Expected<void> open_link(const modes::Entity& node);
  Expected<void> watch_parameters();
  template <class Service, class Handler>
  Expected<void> serve(const std::string& name, Handler handler);

  void on_graph(const ros2::GraphChange& change);
  bool change_mode(const modes::Entity& entity, const std::string& mode);
  bool change_state(const modes::Entity& system, const ros2::msg::Transition& transition);
  void aim(const modes::Entity& entity, const modes::Target& target);
  void steer(const modes::Entity& node, const modes::Target& target);
  void announce(const modes::Entity& entity, const modes::Target& target);
  void watch_overdue(const modes::Entity& entity, const modes::Target& target);
  void update();
  void publish(const modes::Inference::Change& change);
  void apply_rules(const std::vector<modes::Inference::Change>& changes);
  void trouble(const std::string& text);

  const modes::Model& model_;
  const Options options_;
  modes::Inference inference_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::map<std::string, Voice> voices_;                     // by entity
  std::map<std::string, std::unique_ptr<NodeLink>> links_;  // by node
  std::vector<std::unique_ptr<ros2::ServiceServer>> services_;
  std::unique_ptr<ros2::Subscription> parameter_events_;
  ros2::TaskGroup tasks_;
};

}  // namespace culprit::mode_manager
