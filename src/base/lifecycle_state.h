// The states of a managed node (design.ros2.org/articles/node_lifecycle.html), with the numbers of
// lifecycle_msgs: five in which it stays, and six in which it is on its way.
#pragma once

#include <cstdint>

namespace culprit {

enum class LifecycleState : std::uint8_t {
  kUnknown = 0,
  kUnconfigured = 1,
  kInactive = 2,
  kActive = 3,
  kFinalized = 4,
  kConfiguring = 10,
  kCleaningUp = 11,
  kShuttingDown = 12,
  kActivating = 13,
  kDeactivating = 14,
  kErrorProcessing = 15
};

}  // namespace culprit
