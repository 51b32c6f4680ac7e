#pragma once

#include <memory>
#include <string>

#include "behaviortree_cpp/condition_node.h"
#include "culprit_bt/culprit.h"
#include "culprit_bt/health.h"

namespace culprit_bt {

// A condition: whether a component is well, or the whole robot (health.h says what well is).
//
//     <IsHealthy component="base"/>
//
// - SUCCESS: it is.
// - FAILURE: it is not, or that is not known: culprit does not run, does not answer for 3 s, cannot hear the
//   robot, or its rules have no such component. `reason` says which, and the node's log when it changes.
// - Until culprit was heard, a moment after the tree was made, nothing is known. A mission that begins with
//   this condition fails then: let it begin with WaitForRecovery.
class IsHealthy : public BT::ConditionNode {
 public:
  // Throws BT::RuntimeError without a node on the blackboard, and for ports that make no sense.
  IsHealthy(const std::string& name, const BT::NodeConfig& config);

  static BT::PortsList providedPorts();

 private:
  BT::NodeStatus tick() override;

  const std::shared_ptr<Culprit> culprit_;
  Health told_{Outlook::kWell, ""};
};

}  // namespace culprit_bt
