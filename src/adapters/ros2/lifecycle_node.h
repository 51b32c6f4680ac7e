// A managed node: a node with the lifecycle services and ~/transition_event of rclcpp_lifecycle.
//
// - It starts unconfigured. Transitions are asked for through ~/change_state, or by trigger().
// - The callback of a transition does its work on the executor's thread and returns its result;
//   during it the node is in the transition state, and nothing else of the process runs, as with
//   rclcpp's single-threaded executor.
// - Failure returns to the state before, an error calls on_error, whose success leads to
//   unconfigured and whose failure to finalized.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/expected.h"
#include "ros2/lifecycle.h"
#include "ros2/node.h"

namespace culprit::ros2 {

// An empty one counts as success.
struct LifecycleCallbacks {
  using Work = std::function<TransitionResult()>;
  Work on_configure;
  Work on_cleanup;
  Work on_activate;
  Work on_deactivate;
  Work on_shutdown;
  Work on_error;
};

class LifecycleNode {
 public:
  static Expected<std::unique_ptr<LifecycleNode>> create(Context& context, NodeName name,
                                                         LifecycleCallbacks callbacks);

  Node& node() { return *node_; }
  LifecycleState state() const { return machine_.state(); }

  // Whether the transition was possible, and its work a success. On the executor's thread, or
  // before it runs.
  bool trigger(TransitionId transition) {
    return change_state(machine_.find(static_cast<std::uint8_t>(transition)));
  }

 private:
  LifecycleNode(std::unique_ptr<Node> node, LifecycleCallbacks callbacks);
  Expected<void> open();
  template <class Service, class Handler>
  Expected<void> serve(std::string_view name, Handler handler);

  const LifecycleTransition* find(const msg::Transition& asked) const;
  bool change_state(const LifecycleTransition* transition);
  TransitionResult work();
  void publish(const LifecycleTransition& step);

  LifecycleMachine machine_;
  const LifecycleCallbacks callbacks_;
  std::unique_ptr<Node> node_;
  std::optional<Publisher<msg::TransitionEvent>> transition_events_;
  std::vector<std::unique_ptr<ServiceServer>> services_;
};

}  // namespace culprit::ros2
