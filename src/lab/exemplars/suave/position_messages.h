// Positions of the vehicle as messages.
#pragma once

#include "exemplars/suave/model/position.h"
#include "ros2/navigation_messages.h"

namespace culprit::suave::msg {

using ros2::msg::Point;
using ros2::msg::PoseStamped;

inline PoseStamped to_message(const model::Position& p) {
  PoseStamped message;
  message.header.stamp = ros2::msg::to_time(std::chrono::system_clock::now());
  message.header.frame_id = "map";
  message.pose.position = {p.x, p.y, p.z};
  return message;
}

inline model::Position to_position(const PoseStamped& message) {
  const Point& p = message.pose.position;
  return {p.x, p.y, p.z};
}

}  // namespace culprit::suave::msg
