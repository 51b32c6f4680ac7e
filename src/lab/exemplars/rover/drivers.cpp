// The drivers: each turns what its device sends into a topic of ROS.

#include "exemplars/rover/geometry.h"
#include "exemplars/rover/nodes.h"

namespace culprit::rover {
namespace {

// lidar_driver: /scan at 10 Hz.
//
// Faults: "stall", "zeros", "nan", "frozen" (the same scan again), "slow" (2 Hz), "wrong_frame". It is a plain node:
// no lifecycle transition helps.
class LidarDriver final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    offer(scan_, "/scan", rtps::qos::kSensorData);
    hear<msg::LaserScan>("/hardware/lidar", rtps::qos::kSensorData,
                         [this](const msg::LaserScan& scan) { on_scan(scan); });
  }

  void on_scan(msg::LaserScan scan) {
    ++count_;
    if (has("stall") || (has("slow") && count_ % 5 != 0)) return;
    if (has("zeros")) scan.ranges.assign(scan.ranges.size(), 0);
    if (has("nan")) scan.ranges.assign(scan.ranges.size(), std::nanf(""));
    if (has("frozen")) scan.ranges = last_;
    if (has("wrong_frame")) scan.header.frame_id = "lazer";
    last_ = scan.ranges;
    scan_->publish(scan);
  }

  int count_ = 0;
  std::vector<float> last_;
  std::optional<ros2::Publisher<msg::LaserScan>> scan_;
};

// camera_driver: /camera/image_raw at 4 Hz; every 2 s if the parameter exposure is above 1.
//
// Faults: "stall", "dark", "dim" (fog on the lens: no exposure helps).
class CameraDriver final : public RoverNode {
 public:
  explicit CameraDriver(Settings settings)
      : RoverNode(settings, {.parameters = {{"exposure", 1.0}}}) {}

 private:
  void set_up() override {
    offer(image_, "/camera/image_raw", rtps::qos::kSensorData);
    hear<ros2::msg::Image>("/hardware/camera", rtps::qos::kSensorData,
                           [this](ros2::msg::Image image) {
                             const bool is_long = parameter<double>("exposure") > 1;
                             if (has("stall") || (is_long && ++count_ % 8 != 0)) return;
                             if (has("dim")) image.data.assign(image.data.size(), 8);
                             if (has("dark")) image.data.assign(image.data.size(), 0);
                             brightness_ = 0;
                             for (const std::uint8_t pixel : image.data) brightness_ += pixel;
                             brightness_ /= static_cast<double>(image.data.size());
                             image_->publish(image);
                           });
  }
  std::vector<ros2::msg::KeyValue> values() override {
    return {{"brightness", std::to_string(brightness_)}};
  }

  int count_ = 0;
  double brightness_ = 0;
  std::optional<ros2::Publisher<ros2::msg::Image>> image_;
};

// imu_driver: /imu at 20 Hz. Faults: "stall", "bias" (0.5 rad/s).
class ImuDriver final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    offer(imu_, "/imu", rtps::qos::kSensorData);
    hear<msg::Imu>("/hardware/imu", rtps::qos::kSensorData, [this](msg::Imu imu) {
      if (has("stall")) return;
      if (has("bias")) imu.angular_velocity.z += 0.5;
      imu_->publish(imu);
    });
  }

  std::optional<ros2::Publisher<msg::Imu>> imu_;
};

// base_driver: drives as /cmd_vel says, and stops if nothing came for 0.5 s. Integrates the wheels' encoders: /odom and
// odom -> base_link on /tf, 20 Hz. base_link -> laser on /tf_static. Passes on /battery_state. Without the parameter motor_power it stands, and senses.
//
// Faults: "odom_frozen" (encoders read zero), "tf_stopped", "tf_late" (stamps 3 s old), "clock_jump" (an hour),
// "stall" (obeys no command), "slip" (the wheels turn, but the rover does not drive forward).
class BaseDriver final : public RoverNode {
 public:
  explicit BaseDriver(Settings settings)
      : RoverNode(settings, {.parameters = {{"motor_power", true}}}) {}

 private:
  void set_up() override {
    offer(motors_, "/hardware/motors");
    offer(odom_, "/odom");
    offer(tf_, "/tf", {.depth = 100});
    offer(tf_static_, "/tf_static", {.durability = rtps::Durability::kTransientLocal, .depth = 1});
    if (tf_static_) tf_static_->publish({{{header_now("base_link"), "laser", {}}}});
    offer(battery_, "/battery_state");
    hear<msg::Twist>("/cmd_vel", rtps::qos::kDefault, [this](const msg::Twist& twist) {
      command_ = twist;
      commanded_ = ros2::Executor::Clock::now();
    });
    hear<msg::Odometry>("/hardware/wheels", rtps::qos::kSensorData,
                        [this](const msg::Odometry& wheels) { on_wheels(wheels.twist.twist); });
    hear<msg::BatteryState>("/hardware/battery", rtps::qos::kSensorData,
                            [this](const msg::BatteryState& state) { battery_->publish(state); });
    every(50ms, [this] {
      const bool is_fresh = ros2::Executor::Clock::now() - commanded_ < 500ms;
      const bool drives = is_fresh && parameter<bool>("motor_power") && !has("stall");
      ordered_ = drives ? command_ : msg::Twist{};
      motors_->publish(to_twist(has("slip") ? 0 : ordered_.linear.x, ordered_.angular.z));
    });
  }

  void on_wheels(msg::Twist twist) {
    if (has("odom_frozen")) twist = {};
    if (has("slip")) twist.linear.x = ordered_.linear.x;
    pose_ = moved(pose_, twist.linear.x, twist.angular.z, 0.05);
    msg::Header header = header_now("odom");
    if (has("tf_late")) header.stamp.sec -= 3;
    if (has("clock_jump")) header.stamp.sec -= 3600;
    msg::Odometry odom;
    odom.header = header;
    odom.child_frame_id = "base_link";
    odom.pose.pose = to_message(pose_);
    odom.twist.twist = twist;
    odom_->publish(odom);
    if (!has("tf_stopped")) tf_->publish(to_tf(header, "base_link", pose_));
  }

  Pose2 pose_;
  msg::Twist command_;
  msg::Twist ordered_;  // of the wheels
  ros2::Executor::Clock::time_point commanded_{};
  std::optional<ros2::Publisher<msg::Twist>> motors_;
  std::optional<ros2::Publisher<msg::Odometry>> odom_;
  std::optional<ros2::Publisher<msg::TFMessage>> tf_;
  std::optional<ros2::Publisher<msg::TFMessage>> tf_static_;
  std::optional<ros2::Publisher<msg::BatteryState>> battery_;
};

// ekf: no part of the robot. Somebody forgot to stop this filter: it publishes odom -> base_link, too, from where it started.
class Ekf final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    offer(tf_, "/tf", {.depth = 100});
    hear<msg::Odometry>("/hardware/wheels", rtps::qos::kSensorData,
                        [this](const msg::Odometry& wheels) {
                          const msg::Twist& twist = wheels.twist.twist;
                          pose_ = moved(pose_, twist.linear.x, twist.angular.z, 0.05);
                          tf_->publish(to_tf(header_now("odom"), "base_link", pose_));
                        });
  }

  Pose2 pose_;
  std::optional<ros2::Publisher<msg::TFMessage>> tf_;
};

}  // namespace

const Process kEkf = {"ekf", make<Ekf>, false};
const Process kLidarDriver = {"lidar_driver", make<LidarDriver>};
const Process kCameraDriver = {"camera_driver", make<CameraDriver>, true, true};
const Process kImuDriver = {"imu_driver", make<ImuDriver>};
const Process kBaseDriver = {"base_driver", make<BaseDriver>};

}  // namespace culprit::rover
