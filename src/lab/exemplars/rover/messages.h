// The message, service and action types of the rover that ros2/ does not have. Field for field as in the files
// that kType names.
#pragma once

#include "ros2/navigation_messages.h"

namespace culprit::rover::msg {

using ros2::msg::Header;
using ros2::msg::LaserScan;
using ros2::msg::OccupancyGrid;
using ros2::msg::Path;
using ros2::msg::Point;
using ros2::msg::Pose;
using ros2::msg::PoseStamped;
using ros2::msg::Quaternion;
using ros2::msg::TFMessage;
using ros2::msg::Time;
using ros2::msg::TransformStamped;
using ros2::msg::Vector3;

struct Empty {
  static constexpr std::string_view kType = "std_msgs/msg/Empty";
  std::uint8_t structure_needs_at_least_one_member = 0;
  static void visit(auto& self, auto& each) { each(self.structure_needs_at_least_one_member); }
};

struct Duration {
  static constexpr std::string_view kType = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void visit(auto& self, auto& each) { each(self.sec, self.nanosec); }
};

struct PoseWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36> covariance{};
  static void visit(auto& self, auto& each) { each(self.pose, self.covariance); }
};

struct PoseWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header;
  PoseWithCovariance pose;
  static void visit(auto& self, auto& each) { each(self.header, self.pose); }
};

struct Twist {
  static constexpr std::string_view kType = "geometry_msgs/msg/Twist";
  Vector3 linear;
  Vector3 angular;
  static void visit(auto& self, auto& each) { each(self.linear, self.angular); }
};

struct TwistWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist;
  std::array<double, 36> covariance{};
  static void visit(auto& self, auto& each) { each(self.twist, self.covariance); }
};

struct Odometry {
  static constexpr std::string_view kType = "nav_msgs/msg/Odometry";
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  static void visit(auto& self, auto& each) {
    each(self.header, self.child_frame_id, self.pose, self.twist);
  }
};

struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/msg/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;
  std::array<double, 9> linear_acceleration_covariance{};
  static void visit(auto& self, auto& each) {
    each(self.header, self.orientation, self.orientation_covariance, self.angular_velocity,
         self.angular_velocity_covariance, self.linear_acceleration,
         self.linear_acceleration_covariance);
  }
};

struct PointField {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointField";
  std::string name{};
  std::uint32_t offset = 0;
  std::uint8_t datatype = 7;  // float32
  std::uint32_t count = 1;
  static void visit(auto& self, auto& each) {
    each(self.name, self.offset, self.datatype, self.count);
  }
};

struct PointCloud2 {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 12;
  std::uint32_t row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = true;
  static void visit(auto& self, auto& each) {
    each(self.header, self.height, self.width, self.fields, self.is_bigendian, self.point_step,
         self.row_step, self.data, self.is_dense);
  }
};

struct BatteryState {
  static constexpr std::string_view kType = "sensor_msgs/msg/BatteryState";
  Header header;
  float voltage = 0;
  float temperature = 0;
  float current = 0;
  float charge = 0;
  float capacity = 0;
  float design_capacity = 0;
  float percentage = 0;  // 0 to 1
  std::uint8_t power_supply_status = 0;
  std::uint8_t power_supply_health = 0;
  std::uint8_t power_supply_technology = 0;
  bool present = true;
  std::vector<float> cell_voltage;
  std::vector<float> cell_temperature;
  std::string location;
  std::string serial_number;
  static void visit(auto& self, auto& each) {
    each(self.header, self.voltage, self.temperature, self.current, self.charge, self.capacity,
         self.design_capacity, self.percentage, self.power_supply_status, self.power_supply_health,
         self.power_supply_technology, self.present, self.cell_voltage, self.cell_temperature,
         self.location, self.serial_number);
  }
};

// The heartbeat of a bond.
struct BondStatus {
  static constexpr std::string_view kType = "bond/msg/Status";
  Header header;
  std::string id;
  std::string instance_id;
  bool active = false;
  float heartbeat_timeout = 0;
  float heartbeat_period = 0;
  static void visit(auto& self, auto& each) {
    each(self.header, self.id, self.instance_id, self.active, self.heartbeat_timeout,
         self.heartbeat_period);
  }
};

}  // namespace culprit::rover::msg

namespace culprit::rover::srv {

struct Empty {
  static constexpr std::string_view kType = "std_srvs/srv/Empty";
  struct Request {};
  struct Response {};
};

struct ManageLifecycleNodes {
  static constexpr std::string_view kType = "nav2_msgs/srv/ManageLifecycleNodes";
  struct Request {
    std::uint8_t command = 0;  // 0 startup, 1 pause, 2 resume, 3 reset, 4 shutdown
    static void visit(auto& self, auto& each) { each(self.command); }
  };
  struct Response {
    bool success = false;
    static void visit(auto& self, auto& each) { each(self.success); }
  };
};

}  // namespace culprit::rover::srv

// The actions of Nav2, Humble.
namespace culprit::rover::act {

struct NavigateToPose {
  static constexpr std::string_view kType = "nav2_msgs/action/NavigateToPose";
  struct Goal {
    msg::PoseStamped pose;
    std::string behavior_tree;
    static void visit(auto& self, auto& each) { each(self.pose, self.behavior_tree); }
  };
  using Result = msg::Empty;
  struct Feedback {
    msg::PoseStamped current_pose;
    msg::Duration navigation_time;
    msg::Duration estimated_time_remaining;
    std::int16_t number_of_recoveries = 0;
    float distance_remaining = 0;
    static void visit(auto& self, auto& each) {
      each(self.current_pose, self.navigation_time, self.estimated_time_remaining,
           self.number_of_recoveries, self.distance_remaining);
    }
  };
};

struct ComputePathToPose {
  static constexpr std::string_view kType = "nav2_msgs/action/ComputePathToPose";
  struct Goal {
    msg::PoseStamped goal;
    msg::PoseStamped start;
    std::string planner_id;
    bool use_start = false;
    static void visit(auto& self, auto& each) {
      each(self.goal, self.start, self.planner_id, self.use_start);
    }
  };
  struct Result {
    msg::Path path;
    msg::Duration planning_time;
    static void visit(auto& self, auto& each) { each(self.path, self.planning_time); }
  };
  using Feedback = msg::Empty;
};

struct FollowPath {
  static constexpr std::string_view kType = "nav2_msgs/action/FollowPath";
  struct Goal {
    msg::Path path;
    std::string controller_id;
    std::string goal_checker_id;
    static void visit(auto& self, auto& each) {
      each(self.path, self.controller_id, self.goal_checker_id);
    }
  };
  using Result = msg::Empty;
  struct Feedback {
    float distance_to_goal = 0;
    float speed = 0;
    static void visit(auto& self, auto& each) { each(self.distance_to_goal, self.speed); }
  };
};

struct Spin {
  static constexpr std::string_view kType = "nav2_msgs/action/Spin";
  struct Goal {
    float target_yaw = 0;
    msg::Duration time_allowance;
    static void visit(auto& self, auto& each) { each(self.target_yaw, self.time_allowance); }
  };
  using Result = msg::Duration;
  struct Feedback {
    float angular_distance_traveled = 0;
    static void visit(auto& self, auto& each) { each(self.angular_distance_traveled); }
  };
};

struct BackUp {
  static constexpr std::string_view kType = "nav2_msgs/action/BackUp";
  struct Goal {
    msg::Point target;
    float speed = 0;
    msg::Duration time_allowance;
    static void visit(auto& self, auto& each) {
      each(self.target, self.speed, self.time_allowance);
    }
  };
  using Result = msg::Duration;
  struct Feedback {
    float distance_traveled = 0;
    static void visit(auto& self, auto& each) { each(self.distance_traveled); }
  };
};

}  // namespace culprit::rover::act
