// The messages of a robot that drives: where things are, maps, paths and laser scans. Field for field as in the .msg file that
// kType names, and wire-identical from Humble on.
#pragma once

#include "ros2/messages.h"

namespace culprit::ros2::msg {

struct Vector3 {
  static constexpr std::string_view kType = "geometry_msgs/msg/Vector3";
  double x = 0;
  double y = 0;
  double z = 0;
  static void visit(auto& self, auto& each) { each(self.x, self.y, self.z); }
};

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

struct Transform {
  static constexpr std::string_view kType = "geometry_msgs/msg/Transform";
  Vector3 translation;
  Quaternion rotation;
  static void visit(auto& self, auto& each) { each(self.translation, self.rotation); }
};

struct TransformStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;
  static void visit(auto& self, auto& each) {
    each(self.header, self.child_frame_id, self.transform);
  }
};

struct TFMessage {
  static constexpr std::string_view kType = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
  static void visit(auto& self, auto& each) { each(self.transforms); }
};

struct MapMetaData {
  static constexpr std::string_view kType = "nav_msgs/msg/MapMetaData";
  Time map_load_time;
  float resolution = 0;  // m a cell
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin;  // of the corner of the first cell
  static void visit(auto& self, auto& each) {
    each(self.map_load_time, self.resolution, self.width, self.height, self.origin);
  }
};

struct OccupancyGrid {
  static constexpr std::string_view kType = "nav_msgs/msg/OccupancyGrid";
  Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;  // row by row; 0 free to 100 occupied, -1 unknown
  static void visit(auto& self, auto& each) { each(self.header, self.info, self.data); }
};

struct Path {
  static constexpr std::string_view kType = "nav_msgs/msg/Path";
  Header header;
  std::vector<PoseStamped> poses;
  static void visit(auto& self, auto& each) { each(self.header, self.poses); }
};

struct LaserScan {
  static constexpr std::string_view kType = "sensor_msgs/msg/LaserScan";
  Header header;
  float angle_min = 0;
  float angle_max = 0;
  float angle_increment = 0;
  float time_increment = 0;
  float scan_time = 0;
  float range_min = 0;
  float range_max = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
  static void visit(auto& self, auto& each) {
    each(self.header, self.angle_min, self.angle_max, self.angle_increment, self.time_increment,
         self.scan_time, self.range_min, self.range_max, self.ranges, self.intensities);
  }
};

}  // namespace culprit::ros2::msg
