// The messages of geometry_msgs that several robots speak. Field for field as in the files that kType names.
#pragma once

#include <string_view>

#include "ros2/messages.h"

namespace culprit::geometry::msg {

using ros2::msg::Header;

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
  Header header;
  Pose pose;
  static void visit(auto& self, auto& each) { each(self.header, self.pose); }
};

}  // namespace culprit::geometry::msg
