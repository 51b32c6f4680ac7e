#include "doctor/stamped_types.h"

#include <algorithm>
#include <array>

#include "ros2/standard_messages.h"

namespace culprit::doctor {

bool is_stamped_type(const std::string& type) {
  const auto text = ros2::standard_message(type);
  return text && text->starts_with("std_msgs/Header header");
}

bool is_sensor_type(const std::string& type) {
  constexpr std::array kTypes = {"nav_msgs/msg/Odometry",
                                 "sensor_msgs/msg/CameraInfo",
                                 "sensor_msgs/msg/CompressedImage",
                                 "sensor_msgs/msg/FluidPressure",
                                 "sensor_msgs/msg/Image",
                                 "sensor_msgs/msg/Imu",
                                 "sensor_msgs/msg/LaserScan",
                                 "sensor_msgs/msg/MagneticField",
                                 "sensor_msgs/msg/NavSatFix",
                                 "sensor_msgs/msg/PointCloud2",
                                 "sensor_msgs/msg/Range"};
  return std::ranges::find(kTypes, type) != kTypes.end();
}

}  // namespace culprit::doctor
