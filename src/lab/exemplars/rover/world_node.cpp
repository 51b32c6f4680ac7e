// world: the rover's body and surroundings. The drivers see it through topics below /hardware, experiments through
// /world/truth and its status.
//
// Faults of hardware, which no process can mend, are parameters: lidar_plugged, lidar_flaps (a loose plug: out for 3 s of 4 s),
// battery (set it to discharge), kidnap ("x y yaw": somebody carries the robot there).
#include <sstream>

#include "exemplars/rover/nodes.h"
#include "exemplars/rover/world.h"

namespace culprit::rover {
namespace {

class WorldNode final : public RoverNode {
 public:
  explicit WorldNode(Settings settings)
      : RoverNode(settings, {.parameters = {{"lidar_plugged", true},
                                            {"lidar_flaps", false},
                                            {"battery", 1.0},
                                            {"kidnap", ""}}}),
        world_(settings.seed) {}

 private:
  void set_up() override {
    offer(lidar_, "/hardware/lidar", rtps::qos::kSensorData);
    offer(imu_, "/hardware/imu", rtps::qos::kSensorData);
    offer(wheels_, "/hardware/wheels", rtps::qos::kSensorData);
    offer(battery_, "/hardware/battery", rtps::qos::kSensorData);
    offer(camera_, "/hardware/camera", rtps::qos::kSensorData);
    offer(truth_, "/world/truth", rtps::qos::kSensorData);
    hear<msg::Twist>("/hardware/motors", rtps::qos::kDefault, [this](const msg::Twist& twist) {
      world_.drive(twist.linear.x, twist.angular.z);
    });
    every(kTick, [this] { tick(); });
    every(100ms, [this] { publish_scan(); });
    every(250ms, [this] { publish_picture(); });
    every(1s, [this] {
      msg::BatteryState state;
      state.header = header_now("base_link");
      state.voltage = static_cast<float>(20 + 4 * world_.battery());
      state.percentage = static_cast<float>(world_.battery());
      battery_->publish(state);
    });
  }

  void tick() {
    world_.step(seconds(kTick));
    msg::Imu imu;
    imu.header = header_now("imu_link");
    imu.angular_velocity.z = world_.turn();
    imu.linear_acceleration.z = 9.81;
    imu_->publish(imu);
    msg::Odometry all;
    all.header = header_now("map");
    all.child_frame_id = "base_link";
    all.twist.twist = to_twist(world_.speed(), world_.turn());
    wheels_->publish(all);
    all.pose.pose = to_message(world_.robot());
    truth_->publish(all);
  }

  void publish_scan() {
    const bool is_out =
        parameter<bool>("lidar_flaps") && (ros2::Executor::Clock::now() - flaps_since_) % 4s < 3s;
    if (is_out || !parameter<bool>("lidar_plugged")) return;
    msg::LaserScan scan;
    scan.header = header_now("laser");
    scan.angle_min = -std::numbers::pi_v<float>;
    scan.angle_increment = 2 * std::numbers::pi_v<float> / World::kBeams;
    scan.angle_max = -scan.angle_min - scan.angle_increment;
    scan.scan_time = 0.1F;
    scan.range_min = 0.05F;
    scan.range_max = World::kLidarRange;
    scan.ranges = world_.scan();
    lidar_->publish(scan);
  }

  // The walls ahead: the nearer, the higher and brighter.
  void publish_picture() {
    constexpr std::uint32_t kWidth = 48;
    constexpr std::uint32_t kHeight = 36;
    ros2::msg::Image image{.header = header_now("camera"),
                           .height = kHeight,
                           .width = kWidth,
                           .encoding = "mono8",
                           .step = kWidth,
                           .data = std::vector<std::uint8_t>(kWidth * kHeight, 20)};
    const Pose2 robot = world_.robot();
    for (std::uint32_t column = 0; column < kWidth; ++column) {
      const double angle = 0.6 - 1.2 * column / kWidth;
      const double range =
          world_.map().ray({robot.x, robot.y, robot.yaw + angle}, World::kLidarRange);
      const auto half = static_cast<std::uint32_t>(std::min(18.0, 8 / (range + 0.2)));
      for (std::uint32_t row = kHeight / 2 - half; row < kHeight / 2 + half; ++row)
        image.data[row * kWidth + column] = static_cast<std::uint8_t>(240 - 30 * range);
    }
    camera_->publish(image);
  }

  Expected<void> on_set(const ros2::msg::Parameter& change) override {
    if (change.name == "lidar_flaps") flaps_since_ = ros2::Executor::Clock::now();
    if (change.name == "battery") world_.set_battery(change.value.double_value);
    if (change.name != "kidnap" || change.value.string_value.empty()) return {};
    Pose2 to;
    std::istringstream text(change.value.string_value);
    if (!(text >> to.x >> to.y >> to.yaw) || !world_.is_free(to))
      return Error{"kidnap needs \"x y yaw\" of a free place"};
    world_.kidnap(to);
    return {};
  }

  std::vector<ros2::msg::KeyValue> values() override {
    return {{"collisions", std::to_string(world_.collisions())},
            {"driven", std::to_string(world_.driven())}};
  }

  static constexpr Duration kTick = 50ms;
  World world_;
  ros2::Executor::Clock::time_point flaps_since_{};
  std::optional<ros2::Publisher<msg::LaserScan>> lidar_;
  std::optional<ros2::Publisher<msg::Imu>> imu_;
  std::optional<ros2::Publisher<msg::Odometry>> wheels_;
  std::optional<ros2::Publisher<msg::BatteryState>> battery_;
  std::optional<ros2::Publisher<ros2::msg::Image>> camera_;
  std::optional<ros2::Publisher<msg::Odometry>> truth_;
};

}  // namespace

const Process kWorld = {"world", make<WorldNode>, false};

}  // namespace culprit::rover
