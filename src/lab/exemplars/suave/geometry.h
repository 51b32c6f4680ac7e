// The messages of geometry_msgs that the live robot speaks.
#pragma once

#include <string_view>

#include "exemplars/suave/model/position.h"
#include "ros2/messages.h"

namespace culprit::suave::msg {

struct Point {
  static constexpr std::string_view kType = "geometry_msgs/msg/Point";
  double x = 0;
  double y = 0;
  double z = 0;
  static void visit(auto& self, auto& each) { each(self.x, self.y, self.z); }
};

struct Quaternion {
  static constexpr std::string_view kType = "geometry_msgs/msg/Quaternion";
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
  static void visit(auto& self, auto& each) { each(self.x, self.y, self.z, self.w); }
};

struct Pose {
  static constexpr std::string_view kType = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;
  static void visit(auto& self, auto& each) { each(self.position, self.orientation); }
};

struct PoseStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseStamped";
  ros2::msg::Header header;
  Pose pose;
  static void visit(auto& self, auto& each) { each(self.header, self.pose); }
};

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
