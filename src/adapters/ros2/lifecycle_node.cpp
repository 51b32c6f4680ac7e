#include "ros2/lifecycle_node.h"

#include <utility>

#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

template <class Predicate>
srv::GetAvailableTransitions::Response transitions(Predicate wanted) {
  srv::GetAvailableTransitions::Response response;
  for (const LifecycleTransition& transition : lifecycle_transitions()) {
    if (wanted(transition)) response.available_transitions.push_back(to_message(transition));
  }
  return response;
}

}  // namespace

Expected<std::unique_ptr<LifecycleNode>> LifecycleNode::create(Context& context, NodeName name,
                                                               LifecycleCallbacks callbacks) {
  auto node = Node::create(context, std::move(name));
  if (!node) return Error{node.error()};
  std::unique_ptr<LifecycleNode> managed(new LifecycleNode(std::move(*node), std::move(callbacks)));
  if (auto opened = managed->open(); !opened) return Error{opened.error()};
  return managed;
}

LifecycleNode::LifecycleNode(std::unique_ptr<Node> node, LifecycleCallbacks callbacks)
    : callbacks_(std::move(callbacks)), node_(std::move(node)) {}

template <class Service, class Handler>
Expected<void> LifecycleNode::serve(std::string_view name, Handler handler) {
  auto server = node_->create_service<Service>(name, std::move(handler));
  if (!server) return Error{server.error()};
  services_.push_back(std::move(*server));
  return {};
}

Expected<void> LifecycleNode::open() {
  auto events = node_->create_publisher<msg::TransitionEvent>("~/transition_event");
  if (!events) return Error{events.error()};
  transition_events_ = std::move(*events);

  for (auto& opened :
       {serve<srv::ChangeState>("~/change_state",
                                [this](const srv::ChangeState::Request& request) {
                                  return srv::ChangeState::Response{
                                      change_state(find(request.transition))};
                                }),
        serve<srv::GetState>("~/get_state",
                             [this](const srv::GetState::Request&) {
                               return srv::GetState::Response{to_message(machine_.state())};
                             }),
        serve<srv::GetAvailableStates>("~/get_available_states",
                                       [](const srv::GetAvailableStates::Request&) {
                                         srv::GetAvailableStates::Response response;
                                         for (const LifecycleState state : lifecycle_states()) {
                                           response.available_states.push_back(to_message(state));
                                         }
                                         return response;
                                       }),
        serve<srv::GetAvailableTransitions>("~/get_available_transitions",
                                            [this](const srv::GetAvailableTransitions::Request&) {
                                              return transitions(
                                                  [this](const LifecycleTransition& transition) {
                                                    return transition.start == machine_.state();
                                                  });
                                            }),
        serve<srv::GetAvailableTransitions>(
            "~/get_transition_graph", [](const srv::GetAvailableTransitions::Request&) {
              return transitions([](const LifecycleTransition&) { return true; });
            })}) {
    if (!opened) return opened;
  }
  return {};
}

// The label wins: `ros2 service call` leaves the id at 0 when only a label was typed.
const LifecycleTransition* LifecycleNode::find(const msg::Transition& asked) const {
  return asked.label.empty() ? machine_.find(asked.id) : machine_.find(asked.label);
}

bool LifecycleNode::change_state(const LifecycleTransition* transition) {
  if (transition == nullptr) return false;
  publish(machine_.begin(*transition));
  const TransitionResult result = work();
  publish(machine_.finish(result));
  if (machine_.state() == LifecycleState::kErrorProcessing) publish(machine_.finish(work()));
  return result == TransitionResult::kSuccess;
}

// Runs the callback of the node's present transition state.
TransitionResult LifecycleNode::work() {
  const auto run = [](const LifecycleCallbacks::Work& callback) {
    return callback ? callback() : TransitionResult::kSuccess;
  };
  switch (machine_.state()) {
    case LifecycleState::kConfiguring:
      return run(callbacks_.on_configure);
    case LifecycleState::kCleaningUp:
      return run(callbacks_.on_cleanup);
    case LifecycleState::kActivating:
      return run(callbacks_.on_activate);
    case LifecycleState::kDeactivating:
      return run(callbacks_.on_deactivate);
    case LifecycleState::kShuttingDown:
      return run(callbacks_.on_shutdown);
    case LifecycleState::kErrorProcessing:
      return run(callbacks_.on_error);
    default:
      return TransitionResult::kError;  // not a transition state
  }
}

// Only the states, as rcl does: a program that relies on the rest would fail with real nodes.
void LifecycleNode::publish(const LifecycleTransition& step) {
  msg::TransitionEvent event;
  event.start_state = to_message(step.start);
  event.goal_state = to_message(step.goal);
  transition_events_->publish(event);
}

}  // namespace culprit::ros2
