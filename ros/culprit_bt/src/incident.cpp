#include "culprit_bt/incident.h"

#include "culprit_bt/health.h"
#include "ports.h"

namespace culprit_bt {

Incident::Incident(const std::string& name, const BT::NodeConfig& config)
    : BT::DecoratorNode(name, config),
      culprit_(Culprit::of(config, input<std::string>(*this, "culprit"))) {}

BT::PortsList Incident::providedPorts() {
  return with_common_ports(
      {BT::InputPort<std::string>("tolerate", "OK",
                                  "how ill is no incident: OK, NON_CRITICAL or WARNING"),
       BT::OutputPort<std::string>("headline", "what is wrong, or why nothing is known")});
}

void Incident::halt() {
  has_acted_ = false;
  BT::DecoratorNode::halt();
}

BT::NodeStatus Incident::over() {
  has_acted_ = false;
  resetChild();
  resetStatus();  // SKIPPED leaves the status as it was
  return BT::NodeStatus::SKIPPED;
}

BT::NodeStatus Incident::tick() {
  const Health health = incident_at(culprit_->knowledge(), input<std::string>(*this, "component"),
                                    tolerated(input<std::string>(*this, "tolerate")));
  setOutput("headline", health.reason);
  if (health.reason != told_ && !health.reason.empty())
    RCLCPP_WARN(culprit_->thread().node().get_logger(), "%s: %s", name().c_str(),
                health.reason.c_str());
  told_ = health.reason;
  if (health.outlook == Outlook::kWell) return over();
  if (health.outlook == Outlook::kNoSuchComponent) {
    has_acted_ = false;
    resetChild();
    return BT::NodeStatus::FAILURE;
  }
  if (has_acted_) return BT::NodeStatus::RUNNING;
  setStatus(BT::NodeStatus::RUNNING);
  const BT::NodeStatus done = child()->executeTick();
  if (done == BT::NodeStatus::FAILURE) {
    resetChild();
    return BT::NodeStatus::FAILURE;
  }
  // A child that skips itself has nothing to do about this incident.
  if (done != BT::NodeStatus::RUNNING) {
    has_acted_ = true;
    resetChild();
  }
  return BT::NodeStatus::RUNNING;
}

}  // namespace culprit_bt
