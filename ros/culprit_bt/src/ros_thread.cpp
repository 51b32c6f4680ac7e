#include "culprit_bt/ros_thread.h"

#include <chrono>
#include <exception>
#include <utility>

#include "behaviortree_cpp/blackboard.h"

namespace culprit_bt {
namespace {

constexpr const char* kThreadKey = "culprit_bt_ros_thread";
// How long its end may be waited for.
constexpr std::chrono::milliseconds kLook{50};

rclcpp::ExecutorOptions options_of(rclcpp::Node& node) {
  rclcpp::ExecutorOptions options;
  options.context = node.get_node_base_interface()->get_context();
  return options;
}

}  // namespace

std::shared_ptr<RosThread> RosThread::of(const BT::NodeConfig& config) {
  BT::Blackboard& blackboard = *config.blackboard->rootBlackboard();
  std::shared_ptr<RosThread> thread;
  if (blackboard.get(kThreadKey, thread) && thread) return thread;
  rclcpp::Node::SharedPtr node;
  if (!blackboard.get(kNodeKey, node) || !node) {
    throw BT::RuntimeError(
        "the leaves of culprit_bt need a ROS 2 node: before the tree is made write "
        "blackboard->set<rclcpp::Node::SharedPtr>(\"node\", node)");
  }
  thread = std::make_shared<RosThread>(node);
  blackboard.set(kThreadKey, thread);
  return thread;
}

RosThread::RosThread(rclcpp::Node::SharedPtr node)
    : node_(std::move(node)),
      group_(node_->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive,
                                          /*automatically_add_to_executor_with_node=*/false)),
      executor_(options_of(*node_)) {
  executor_.add_callback_group(group_, node_->get_node_base_interface());
  thread_ = std::thread([this] { run(); });
}

RosThread::~RosThread() {
  ends_ = true;
  thread_.join();
}

void RosThread::run() {
  const auto context = node_->get_node_base_interface()->get_context();
  try {
    // Not spin(): a cancel() that comes before it begins would be lost.
    while (!ends_ && rclcpp::ok(context)) executor_.spin_once(kLook);
  } catch (const std::exception& error) {
    // While ROS is shut down nothing is heard any more, and so nothing is known.
    if (rclcpp::ok(context)) {
      RCLCPP_ERROR(node_->get_logger(), "nothing of culprit is heard any more: %s", error.what());
    }
  }
}

}  // namespace culprit_bt
