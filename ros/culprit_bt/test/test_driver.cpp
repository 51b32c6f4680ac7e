// A node of the live test's robot: /camera, which says something ten times a second. Its process is killed.
#include <chrono>

#include "builtin_interfaces/msg/time.hpp"
#include "rclcpp/rclcpp.hpp"

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  const auto node = rclcpp::Node::make_shared("camera");
  const auto beat = node->create_publisher<builtin_interfaces::msg::Time>("/beat", 10);
  const auto timer = node->create_wall_timer(std::chrono::milliseconds(100), [&] {
    const builtin_interfaces::msg::Time now = node->now();
    beat->publish(now);
  });
  rclcpp::spin(node);
  rclcpp::shutdown();
  return 0;
}
