#include "ros2/lifecycle.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/invariant.h"

namespace culprit::ros2 {
namespace {

using enum LifecycleState;

constexpr std::array kStates = {kUnknown,    kUnconfigured, kInactive,       kActive,
                                kFinalized,  kConfiguring,  kCleaningUp,     kShuttingDown,
                                kActivating, kDeactivating, kErrorProcessing};

constexpr std::string_view kSuccess = "transition_success";
constexpr std::string_view kFailure = "transition_failure";
constexpr std::string_view kError = "transition_error";

constexpr auto kTransitions = std::to_array<LifecycleTransition>({
    {1, "configure", kUnconfigured, kConfiguring},   {10, kSuccess, kConfiguring, kInactive},
    {11, kFailure, kConfiguring, kUnconfigured},     {12, kError, kConfiguring, kErrorProcessing},

    {2, "cleanup", kInactive, kCleaningUp},          {20, kSuccess, kCleaningUp, kUnconfigured},
    {21, kFailure, kCleaningUp, kInactive},          {22, kError, kCleaningUp, kErrorProcessing},

    {3, "activate", kInactive, kActivating},         {30, kSuccess, kActivating, kActive},
    {31, kFailure, kActivating, kInactive},          {32, kError, kActivating, kErrorProcessing},

    {4, "deactivate", kActive, kDeactivating},       {40, kSuccess, kDeactivating, kInactive},
    {41, kFailure, kDeactivating, kActive},          {42, kError, kDeactivating, kErrorProcessing},

    {5, "shutdown", kUnconfigured, kShuttingDown},   {6, "shutdown", kInactive, kShuttingDown},
    {7, "shutdown", kActive, kShuttingDown},         {50, kSuccess, kShuttingDown, kFinalized},
    {51, kFailure, kShuttingDown, kFinalized},       {52, kError, kShuttingDown, kErrorProcessing},

    {60, kSuccess, kErrorProcessing, kUnconfigured}, {61, kFailure, kErrorProcessing, kFinalized},
    {62, kError, kErrorProcessing, kFinalized},
});

constexpr std::string_view label_of(TransitionResult result) {
  switch (result) {
    case TransitionResult::kSuccess:
      return kSuccess;
    case TransitionResult::kFailure:
      return kFailure;
    case TransitionResult::kError:
      return kError;
  }
  return kError;
}

}  // namespace

std::string_view label_of(LifecycleState state) {
  switch (state) {
    case kUnknown:
      return "unknown";
    case kUnconfigured:
      return "unconfigured";
    case kInactive:
      return "inactive";
    case kActive:
      return "active";
    case kFinalized:
      return "finalized";
    case kConfiguring:
      return "configuring";
    case kCleaningUp:
      return "cleaningup";
    case kShuttingDown:
      return "shuttingdown";
    case kActivating:
      return "activating";
    case kDeactivating:
      return "deactivating";
    case kErrorProcessing:
      return "errorprocessing";
  }
  return "unknown";
}

msg::State to_message(LifecycleState state) {
  return {static_cast<std::uint8_t>(state), std::string(label_of(state))};
}

msg::TransitionDescription to_message(const LifecycleTransition& transition) {
  return {{transition.id, std::string(transition.label)},
          to_message(transition.start),
          to_message(transition.goal)};
}

std::span<const LifecycleState> lifecycle_states() { return kStates; }
std::span<const LifecycleTransition> lifecycle_transitions() { return kTransitions; }

const LifecycleTransition* LifecycleMachine::find(std::uint8_t id) const {
  const auto found = std::ranges::find_if(kTransitions, [&](const auto& transition) {
    return transition.start == state_ && transition.id == id;
  });
  return found == kTransitions.end() ? nullptr : &*found;
}

const LifecycleTransition* LifecycleMachine::find(std::string_view label) const {
  const auto found = std::ranges::find_if(kTransitions, [&](const auto& transition) {
    return transition.start == state_ && transition.label == label;
  });
  return found == kTransitions.end() ? nullptr : &*found;
}

LifecycleTransition LifecycleMachine::begin(const LifecycleTransition& transition) {
  CULPRIT_ASSERT(transition.start == state_);
  state_ = transition.goal;
  return transition;
}

LifecycleTransition LifecycleMachine::finish(TransitionResult result) {
  const LifecycleTransition* found = find(label_of(result));
  CULPRIT_ASSERT(found != nullptr);
  const LifecycleTransition transition = *found;
  state_ = transition.goal;
  return transition;
}

}  // namespace culprit::ros2
