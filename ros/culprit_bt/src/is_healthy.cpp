#include "culprit_bt/is_healthy.h"

#include "ports.h"

namespace culprit_bt {

IsHealthy::IsHealthy(const std::string& name, const BT::NodeConfig& config)
    : BT::ConditionNode(name, config),
      culprit_(Culprit::of(config, input<std::string>(*this, "culprit"))) {}

BT::PortsList IsHealthy::providedPorts() {
  return with_common_ports(
      {BT::InputPort<std::string>("tolerate", "OK",
                                  "how ill is well enough: OK, NON_CRITICAL or WARNING"),
       BT::OutputPort<std::string>("reason", "why not; empty if it is")});
}

BT::NodeStatus IsHealthy::tick() {
  const Health health = health_of(culprit_->knowledge(), input<std::string>(*this, "component"),
                                  tolerated(input<std::string>(*this, "tolerate")));
  setOutput("reason", health.reason);
  if (health.reason != told_.reason && !health.reason.empty())
    RCLCPP_WARN(culprit_->thread().node().get_logger(), "%s: %s", name().c_str(),
                health.reason.c_str());
  told_ = health;
  return health.outlook == Outlook::kWell ? BT::NodeStatus::SUCCESS : BT::NodeStatus::FAILURE;
}

}  // namespace culprit_bt
