// controller_server: the action follow_path by pure pursuit, on the local costmap: what the lidar sees within 1.5 m.
//
// It stops before an obstacle and while its transforms or the scan are missing, and aborts if that lasts, or if the robot makes
// no progress for 8 s.
//
// Parameter: max_speed, metres a second. Faults: "costmap_frozen" (it is neither updated nor published), "oscillate".
#include "exemplars/rover/action.h"
#include "exemplars/rover/costmap.h"
#include "exemplars/rover/nodes.h"
#include "exemplars/rover/pure_pursuit.h"
#include "exemplars/rover/tf_buffer.h"
#include "exemplars/rover/world.h"

namespace culprit::rover {
namespace {

using SteadyTime = ros2::Executor::Clock::time_point;

constexpr double kMaxSpeed = 0.5;
constexpr double kReached = 0.2;     // metres
constexpr double kLooksAhead = 0.8;  // metres
constexpr double kStopsAt = 0.25;    // metres

class ControllerServer final : public RoverNode {
 public:
  explicit ControllerServer(Settings settings)
      : RoverNode(settings, {.parameters = {{"max_speed", kMaxSpeed}},
                             .cleared_by_activate = {"costmap_frozen"}}) {}

 private:
  void set_up() override {
    offer(twist_, "/cmd_vel_nav");
    hear<msg::TFMessage>("/tf", {.depth = 100}, [this](const auto& tf) { tf_.add(tf); });
    hear<msg::LaserScan>("/scan", rtps::qos::kSensorData, [this](const msg::LaserScan& scan) {
      const auto robot = tf_.in_odom();
      if (!robot || has("costmap_frozen") || scan.header.frame_id != "laser") return;
      obstacles_ = obstacles_in(scan, *robot, 1.5);
      seen_ = ros2::Executor::Clock::now();
    });
    join(action_);
    every(100ms, [this] { control(); });
    join(costmap_);
  }
  Expected<void> on_activate() override {
    costmap_.activate();
    return {};
  }
  void on_deactivate() override {
    costmap_.deactivate();
    finish(Status::kAborted);
  }

  // In the frame odom, moved so that its origin is the map's corner.
  std::optional<msg::OccupancyGrid> draw() {
    const auto robot = tf_.in_odom();
    if (!robot || has("costmap_frozen")) return std::nullopt;
    constexpr int kCells = 30;
    GridMap window(kCells, kCells);
    const Pose2 corner{robot->x - kCells / 2 * GridMap::kResolution,
                       robot->y - kCells / 2 * GridMap::kResolution, 0};
    std::vector<Pose2> points;
    for (const Pose2& each : obstacles_)
      points.push_back({each.x - corner.x, each.y - corner.y, 0});
    auto grid = draw_costs(CostGrid(window, points), kCells, kCells);
    grid.header.frame_id = "odom";
    grid.info.origin.position = {corner.x, corner.y, 0};
    return grid;
  }

  bool accept(const act::FollowPath::Goal& goal) {
    if (!is_active() || goal.path.poses.empty()) return false;
    const bool is_new = path_.empty();
    path_.clear();
    for (const auto& pose : goal.path.poses) path_.push_back(to_pose(pose.pose));
    if (is_new) moved_ = well_ = ros2::Executor::Clock::now();
    return true;
  }

  void control() {
    if (!action_.is_running()) return;
    if (action_.is_cancelled()) return finish(Status::kCanceled);
    const SteadyTime now = ros2::Executor::Clock::now();
    const auto in_map = tf_.in_map();
    const auto in_odom = tf_.in_odom();
    const bool sees = now - seen_ < 1s;
    if (!in_map || !in_odom || !sees) {
      twist_->publish(msg::Twist{});
      if (now - well_ > 3s) finish(Status::kAborted);
      return;
    }
    well_ = now;
    if (distance(*in_map, path_.back()) < kReached) return finish(Status::kSucceeded);
    if (distance(*in_map, progress_) > 0.2 ||
        std::abs(normalized(in_map->yaw - progress_.yaw)) > 0.8) {
      progress_ = *in_map;
      moved_ = now;
    }
    if (now - moved_ > 8s) return finish(Status::kAborted);
    drive(*in_map, *in_odom);
  }

  void drive(const Pose2& in_map, const Pose2& in_odom) {
    Command command = pursue(path_, in_map, parameter<double>("max_speed"));
    const double free = free_length(in_odom, command, kLooksAhead, [this](const Pose2& at) {
      return std::ranges::any_of(
          obstacles_, [&](const Pose2& each) { return distance(each, at) < World::kRobotRadius; });
    });
    if (free < kLooksAhead) command.speed = free < kStopsAt ? 0 : std::min(command.speed, 0.15);
    if (has("oscillate")) command.turn = (side_ = -side_);
    twist_->publish(to_twist(command.speed, command.turn));
    action_.feed_back(
        {static_cast<float>(distance(in_map, path_.back())), static_cast<float>(command.speed)});
  }

  void finish(Status status) {
    if (!action_.is_running()) return;
    twist_->publish(msg::Twist{});
    path_.clear();
    action_.end(status);
  }

  TfBuffer tf_;
  std::vector<Pose2> path_;       // in the map
  std::vector<Pose2> obstacles_;  // in odom
  SteadyTime seen_{};             // the last scan
  SteadyTime well_{};             // all inputs were there
  SteadyTime moved_{};
  Pose2 progress_;  // where it last moved
  double side_ = 1.2;
  Costmap costmap_{"local_costmap", 500ms, [this] { return draw(); }};
  ActionServer<act::FollowPath> action_{"/follow_path",
                                        [this](const auto& goal) { return accept(goal); }};
  std::optional<ros2::Publisher<msg::Twist>> twist_;
};

}  // namespace

const Process kControllerServer = {"controller_server", make<ControllerServer>};

}  // namespace culprit::rover
