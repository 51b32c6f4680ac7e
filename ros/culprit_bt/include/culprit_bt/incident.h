#pragma once

#include <memory>
#include <string>

#include "behaviortree_cpp/decorator_node.h"
#include "culprit_bt/culprit.h"

namespace culprit_bt {

// A decorator: its child is what is to be done while there is an incident at a component, or anywhere on the
// robot. In a ReactiveSequence before the mission it stops the mission for as long:
//
//     <ReactiveSequence>
//       <Incident component="base">
//         <Sequence> <StopBase/> <WaitForRecovery component="base" timeout="120"/> </Sequence>
//       </Incident>
//       <Mission/>
//     </ReactiveSequence>
//
// - SKIPPED: there is none, and what comes next is ticked. If one is over while the child runs, the child is
//   halted.
// - RUNNING: there is one: the child runs, or has succeeded before. It is ticked once for each incident; what
//   comes next waits until the incident is over, not only until the child has done its part.
// - FAILURE: the child failed, or the rules have no such component: a mission must not run unguarded because
//   of a name that is mistyped.
// - Where nothing is known (culprit does not run, does not answer, cannot hear the robot) that counts as an
//   incident: the robot stops, and goes on once it is known to be well. A WaitForRecovery in the child ends
//   that with FAILURE where it has to end.
// - An incident is at a component while the component is not well (health.h), or culprit holds it responsible
//   or suspects it. `headline` says what is wrong.
class Incident : public BT::DecoratorNode {
 public:
  // Throws as IsHealthy does.
  Incident(const std::string& name, const BT::NodeConfig& config);

  static BT::PortsList providedPorts();
  void halt() override;

 private:
  BT::NodeStatus tick() override;
  BT::NodeStatus over();

  const std::shared_ptr<Culprit> culprit_;
  bool has_acted_ = false;  // the child has succeeded in this incident
  std::string told_;
};

}  // namespace culprit_bt
