#pragma once

#include <memory>
#include <string>

#include "behaviortree_cpp/action_node.h"
#include "culprit_bt/ros_thread.h"
#include "rclcpp/rclcpp.hpp"
#include "system_modes_msgs/srv/change_mode.hpp"
#include "system_modes_msgs/srv/get_mode.hpp"

namespace culprit_bt {

// An action: brings a system, or a node, into a mode, and waits until it is in it.
//
//     <RequestMode system="drive_base" mode="SLOW" timeout="15"/>
//
// It asks whoever serves the modes: `culprit modes MODEL.yaml`, or the mode_manager of system_modes. A running
// `culprit run` takes no order that sets a mode; its rules do (change_mode), and where they set another one the
// two are rivals.
//
// - RUNNING: it is asked for, or accepted and not there yet. A request that is accepted is not done.
// - SUCCESS: the mode was read back, and is the one that was asked for.
// - FAILURE: it was refused, or `timeout` seconds are over: no node serves the mode, nobody answers, or it was
//   accepted and another mode is read. `reason` says which.
// - Halted: it waits no longer. An accepted request stays: the mode that was wanted before is unknown.
class RequestMode : public BT::StatefulActionNode {
 public:
  // Throws BT::RuntimeError without a node on the blackboard.
  RequestMode(const std::string& name, const BT::NodeConfig& config);

  static BT::PortsList providedPorts();

 private:
  using Change = system_modes_msgs::srv::ChangeMode;
  using Get = system_modes_msgs::srv::GetMode;
  using Clock = std::chrono::steady_clock;
  struct Answers;  // that have come; callbacks may come after the leaf has forgotten them

  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;

  void read_back();
  BT::NodeStatus fail(const std::string& reason);
  std::string why_late() const;

  const std::shared_ptr<RosThread> thread_;

  std::string system_;  // its full name
  std::string mode_;
  rclcpp::Client<Change>::SharedPtr change_;
  rclcpp::Client<Get>::SharedPtr get_;
  Clock::time_point ends_{};
  Clock::time_point read_{};          // asked for, last
  std::shared_ptr<Answers> answers_;  // null: nothing was asked for
  std::string seen_;                  // the mode that was read last
};

}  // namespace culprit_bt
