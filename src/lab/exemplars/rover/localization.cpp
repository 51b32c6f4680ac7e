// map_server and amcl.
#include <fstream>

#include "exemplars/rover/nodes.h"
#include "exemplars/rover/particle_filter.h"
#include "exemplars/rover/tf_buffer.h"
#include "exemplars/rover/world.h"

namespace culprit::rover {
namespace {

constexpr rtps::Qos kLateJoiners{.durability = rtps::Durability::kTransientLocal, .depth = 1};

// map_server: /map, for those who come later, too.
class MapServer final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override { offer(map_, "/map", kLateJoiners); }
  Expected<void> on_activate() override {
    map_->publish(GridMap::house().to_message());
    return {};
  }

  std::optional<ros2::Publisher<msg::OccupancyGrid>> map_;
};

// amcl: from /map, /scan and the odometry the robot's place in the map: map -> odom on /tf, and /amcl_pose, with each scan.
//
// It begins at the place that it wrote down last, or at the parameter initial_pose. Its status has `match`, the share of the beams
// that fit the map. If it is lost, /reinitialize_global_localization looks for the best fit in the whole map.
//
// Faults: "stall", "tf_stopped".
class Amcl final : public RoverNode {
 public:
  explicit Amcl(Settings settings)
      : RoverNode(settings, {.cleared_by_activate = {"stall", "tf_stopped"}}) {}

 private:
  void set_up() override {
    filter_.reset();
    offer(tf_out_, "/tf", {.depth = 100});
    offer(pose_, "/amcl_pose", kLateJoiners);
    hear<msg::TFMessage>("/tf", {.depth = 100}, [this](const auto& tf) { tf_.add(tf); });
    auto map = node().create_subscription<msg::OccupancyGrid>(
        "/map", kLateJoiners, [this](const msg::OccupancyGrid& grid) { on_map(grid); });
    if (map) map_ = std::move(*map);
    hear<msg::LaserScan>("/scan", rtps::qos::kSensorData,
                         [this](const msg::LaserScan& scan) { on_scan(scan); });
    serve<srv::Empty>("/reinitialize_global_localization", [this](const auto&) {
      is_lost_ = true;
      return srv::Empty::Response{};
    });
  }

  void on_map(const msg::OccupancyGrid& map) {
    if (filter_) return;
    filter_.emplace(GridMap::from_message(map), settings().seed);
    Pose2 last = World::kStart;
    std::ifstream(settings().state / "amcl_pose") >> last.x >> last.y >> last.yaw;
    filter_->place(last);
    at_.reset();
  }

  void on_scan(const msg::LaserScan& scan) {
    const auto odom = tf_.in_odom();
    if (!filter_ || !odom || has("stall") || scan.header.frame_id != "laser") return;
    const ParticleFilter::Scan seen{scan.ranges, static_cast<double>(scan.range_max) - 0.05};
    if (std::exchange(is_lost_, false)) {
      filter_->place_anywhere(seen);
      at_ = odom;
    }
    if (!at_) at_ = odom;
    const Pose2 motion = inverse(*at_) * *odom;
    const bool has_moved = std::hypot(motion.x, motion.y) > 0.05 || std::abs(motion.yaw) > 0.05;
    if (has_moved || ++skipped_ >= 5) {
      filter_->update(motion, seen);
      at_ = odom;
      skipped_ = 0;
      keep();
    }
    publish(*odom);
  }

  void publish(const Pose2& odom) {
    const ParticleFilter::Estimate& here = filter_->estimate();
    const Pose2 correction = here.pose * inverse(*at_);
    if (!has("tf_stopped")) tf_out_->publish(to_tf(header_now("map"), "odom", correction));
    msg::PoseWithCovarianceStamped pose;
    pose.header = header_now("map");
    pose.pose.pose = to_message(correction * odom);
    pose.pose.covariance[0] = here.variance_x;
    pose.pose.covariance[7] = here.variance_y;
    pose_->publish(pose);
  }

  // For the next process.
  void keep() {
    if (settings().state.empty() || filter_->estimate().match < 0.6) return;
    const Pose2& pose = filter_->estimate().pose;
    std::ofstream(settings().state / "amcl_pose") << pose.x << ' ' << pose.y << ' ' << pose.yaw;
  }

  std::vector<ros2::msg::KeyValue> values() override {
    if (!filter_) return {};
    return {{"match", std::to_string(filter_->estimate().match)}};
  }

  TfBuffer tf_;
  std::optional<ParticleFilter> filter_;
  std::optional<Pose2> at_;  // in odom, at the last update
  int skipped_ = 0;
  bool is_lost_ = false;
  std::unique_ptr<ros2::Subscription> map_;
  std::optional<ros2::Publisher<msg::TFMessage>> tf_out_;
  std::optional<ros2::Publisher<msg::PoseWithCovarianceStamped>> pose_;
};

}  // namespace

const Process kMapServer = {"map_server", make<MapServer>};
const Process kAmcl = {"amcl", make<Amcl>};

}  // namespace culprit::rover
