// The action ~/wait_for_recovery (culprit_msgs/action/WaitForRecovery) at culprit's own node, as rclcpp and
// rclpy ask for actions: three services and two topics below ~/wait_for_recovery/_action (rcl_action).
//
// It orders nothing, so it is always offered. Its data about the robot are those that are published
// anyway (told()). If the node leaves, its goals end without a result.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ros2/context.h"
#include "ros_api/message_codec.h"

namespace culprit::ros_api {

class RecoveryAction {
 public:
  explicit RecoveryAction(const CulpritTypes& types);  // which outlive it
  ~RecoveryAction();

  // Offers it at this node, which outlives that, until close() is called. Gives what could not be offered,
  // and why, a line each.
  std::vector<std::string> open(ros2::NodeEntry& node);
  void close();

  // A culprit_msgs/msg/Status as it was published. On the thread that opens and closes.
  void told(const Json& status);

 private:
  class Offer;

  const CulpritTypes& types_;
  std::unique_ptr<Offer> offer_;  // null: there is no node now
};

}  // namespace culprit::ros_api
