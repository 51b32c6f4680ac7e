// planner_server: the action compute_path_to_pose by A*, on the global costmap: the map, and what the lidar sees within 2 m.
//
// Fault: "costmap_frozen" (it is neither updated nor published).
#include "exemplars/rover/action.h"
#include "exemplars/rover/costmap.h"
#include "exemplars/rover/nodes.h"
#include "exemplars/rover/tf_buffer.h"

namespace culprit::rover {
namespace {

class PlannerServer final : public RoverNode {
 public:
  explicit PlannerServer(Settings settings)
      : RoverNode(settings, {.cleared_by_activate = {"costmap_frozen"}}) {}

 private:
  void set_up() override {
    hear<msg::TFMessage>("/tf", {.depth = 100}, [this](const auto& tf) { tf_.add(tf); });
    auto map = node().create_subscription<msg::OccupancyGrid>(
        "/map", {.durability = rtps::Durability::kTransientLocal, .depth = 1},
        [this](const msg::OccupancyGrid& grid) {
          map_ = GridMap::from_message(grid);
          costs_.emplace(*map_, std::vector<Pose2>{});
        });
    if (map) map_subscription_ = std::move(*map);
    hear<msg::LaserScan>("/scan", rtps::qos::kSensorData, [this](const msg::LaserScan& scan) {
      const auto robot = tf_.in_map();
      if (!robot || !map_ || has("costmap_frozen") || ++scans_ % 5 != 0) return;
      costs_.emplace(*map_, obstacles_in(scan, *robot, 2));
    });
    join(action_);
    offer(plan_, "/plan");
    join(costmap_);
  }
  Expected<void> on_activate() override {
    costmap_.activate();
    return {};
  }
  void on_deactivate() override {
    costmap_.deactivate();
    action_.end(Status::kAborted);
  }

  std::optional<msg::OccupancyGrid> draw() {
    if (!costs_ || has("costmap_frozen")) return std::nullopt;
    return draw_costs(*costs_, map_->width(), map_->height());
  }

  bool accept(const act::ComputePathToPose::Goal& goal) {
    if (!is_active()) return false;
    // After the answer that accepts it.
    tasks_.emplace(executor());
    tasks_->post([this, goal] { plan(goal); });
    return true;
  }
  void plan(const act::ComputePathToPose::Goal& goal) {
    const auto robot = tf_.in_map();
    if (!robot || !costs_) return action_.end(Status::kAborted);
    msg::Path path;
    path.header = header_now("map");
    for (const Pose2& pose : search_path(*costs_, *robot, to_pose(goal.goal.pose)))
      path.poses.push_back({path.header, to_message(pose)});
    if (path.poses.empty()) return action_.end(Status::kAborted);
    plan_->publish(path);
    action_.end(Status::kSucceeded, {std::move(path), {}});
  }

  TfBuffer tf_;
  std::optional<GridMap> map_;
  std::optional<CostGrid> costs_;
  int scans_ = 0;
  Costmap costmap_{"global_costmap", 1s, [this] { return draw(); }};
  ActionServer<act::ComputePathToPose> action_{"/compute_path_to_pose",
                                               [this](const auto& goal) { return accept(goal); }};
  std::unique_ptr<ros2::Subscription> map_subscription_;
  std::optional<ros2::Publisher<msg::Path>> plan_;
  std::optional<ros2::TaskGroup> tasks_;
};

}  // namespace

const Process kPlannerServer = {"planner_server", make<PlannerServer>};

}  // namespace culprit::rover
