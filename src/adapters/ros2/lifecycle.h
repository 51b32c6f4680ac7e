// The state machine of a managed node (design.ros2.org/articles/node_lifecycle.html), with the
// numbers and labels of lifecycle_msgs and the transitions of rcl_lifecycle.
//
// A transition takes two steps. It is begun: the node is in a transition state, "activating", and
// does its work. Then the result of that work finishes it: on to the goal, back to where it came
// from, or to error processing, whose own result leads to unconfigured or finalized.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "base/lifecycle_state.h"
#include "ros2/messages.h"

namespace culprit::ros2 {

// Those that can be asked for.
enum class TransitionId : std::uint8_t {
  kConfigure = 1,
  kCleanup = 2,
  kActivate = 3,
  kDeactivate = 4,
  kUnconfiguredShutdown = 5,
  kInactiveShutdown = 6,
  kActiveShutdown = 7
};

// The result of a node's work in a transition.
enum class TransitionResult : std::uint8_t { kSuccess, kFailure, kError };

struct LifecycleTransition {
  std::uint8_t id;
  std::string_view label;
  LifecycleState start;
  LifecycleState goal;
};

std::string_view label_of(LifecycleState state);
msg::State to_message(LifecycleState state);
msg::TransitionDescription to_message(const LifecycleTransition& transition);

std::span<const LifecycleState> lifecycle_states();
// All of them, also those that finish a transition, in the order in which rcl lists them.
std::span<const LifecycleTransition> lifecycle_transitions();

class LifecycleMachine {
 public:
  LifecycleState state() const { return state_; }

  // Whether the transition can be asked for now.
  const LifecycleTransition* find(std::uint8_t id) const;
  const LifecycleTransition* find(std::string_view label) const;

  // Both give the step that was made, for the transition event. @pre find(...) of a transition in
  // this state
  LifecycleTransition begin(const LifecycleTransition& transition);
  // @pre in a transition state, or in error processing
  LifecycleTransition finish(TransitionResult result);

 private:
  LifecycleState state_ = LifecycleState::kUnconfigured;
};

}  // namespace culprit::ros2
