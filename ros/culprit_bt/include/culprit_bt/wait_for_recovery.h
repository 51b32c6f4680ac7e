#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "behaviortree_cpp/action_node.h"
#include "culprit_bt/culprit.h"
#include "culprit_msgs/action/wait_for_recovery.hpp"
#include "rclcpp_action/rclcpp_action.hpp"

namespace culprit_bt {

// An action: waits until a component is well again, or the whole robot, by culprit's action
// ~/wait_for_recovery. It orders nothing.
//
//     <WaitForRecovery component="base" timeout="120" doing="{doing}"/>
//
// - RUNNING: it is not well yet. `doing` says what is wrong and what is done about it, and `needs_person`
//   whether culprit cannot help itself.
// - SUCCESS: it is well; at once if it was.
// - FAILURE: `timeout` seconds are over (0: as long as it takes), the rules have no such component, culprit
//   refused, or it could not be reached for `unreachable` seconds together. `reason` says which.
// - If culprit ends, is started again or reloads its rules, the next one is asked; the timeout goes on.
// - Halted: the goal is canceled.
class WaitForRecovery : public BT::StatefulActionNode {
 public:
  // Throws as IsHealthy does.
  WaitForRecovery(const std::string& name, const BT::NodeConfig& config);
  ~WaitForRecovery() override;

  static BT::PortsList providedPorts();

 private:
  using Action = culprit_msgs::action::WaitForRecovery;
  using Clock = Culprit::Clock;
  struct Goal;  // what becomes of one that was sent

  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;

  void send(std::uint64_t life);
  void give_up();  // the goal that was sent
  BT::NodeStatus fail(const std::string& reason);

  const std::shared_ptr<Culprit> culprit_;
  rclcpp_action::Client<Action>::SharedPtr client_;

  std::string component_;
  std::chrono::duration<double> unreachable_{};
  Clock::time_point ends_{};     // max(): as long as it takes
  Clock::time_point reached_{};  // culprit, last
  std::uint64_t life_ = 0;       // of the culprit that was asked
  std::shared_ptr<Goal> goal_;   // null: nothing was asked yet
};

}  // namespace culprit_bt
