// Where the leaves of a tree hear ROS 2: callbacks of their own, on a thread of their own.
//
// So what a leaf knows depends neither on whether the program spins its node, nor on how often it ticks
// the tree. All leaves of a tree share one.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "behaviortree_cpp/tree_node.h"
#include "rclcpp/rclcpp.hpp"

namespace culprit_bt {

class RosThread {
 public:
  // The blackboard's entry of the tree's node, an rclcpp::Node::SharedPtr, as Nav2 calls it.
  static constexpr const char* kNodeKey = "node";

  // That of the tree that a leaf with this configuration belongs to. Throws BT::RuntimeError, with what to
  // write, if the blackboard has no node.
  static std::shared_ptr<RosThread> of(const BT::NodeConfig& config);

  explicit RosThread(rclcpp::Node::SharedPtr node);
  ~RosThread();
  RosThread(const RosThread&) = delete;
  RosThread& operator=(const RosThread&) = delete;

  rclcpp::Node& node() const { return *node_; }
  rclcpp::Node::SharedPtr shared_node() const { return node_; }
  // Subscriptions and clients that are made with it call back on this thread, one after the other.
  rclcpp::CallbackGroup::SharedPtr group() const { return group_; }

 private:
  void run();

  const rclcpp::Node::SharedPtr node_;
  const rclcpp::CallbackGroup::SharedPtr group_;
  rclcpp::executors::SingleThreadedExecutor executor_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace culprit_bt
