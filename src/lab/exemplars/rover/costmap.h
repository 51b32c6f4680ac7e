// The costmap node that lives in the process of a server: /local_costmap/local_costmap of the controller,
// /global_costmap/global_costmap of the planner. The server configures, activates and deactivates it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "exemplars/rover/path_search.h"
#include "exemplars/rover/rover_node.h"

namespace culprit::rover {

class Costmap {
 public:
  // `name`: "local_costmap". Publishes what `draw` gives each period while it is active; nothing: it has none yet.
  Costmap(std::string name, Duration period,
          std::function<std::optional<msg::OccupancyGrid>()> draw)
      : name_(std::move(name)), period_(period), draw_(std::move(draw)) {}

  // Once: it is there from the first configuring of the server on.
  Expected<void> open(ros2::Node& server) {
    if (node_) return {};
    auto made = ros2::LifecycleNode::create(server.context(), {"/" + name_, name_}, {});
    if (!made) return Error{made.error()};
    node_ = std::move(*made);
    auto grid = node_->node().create_publisher<msg::OccupancyGrid>(
        "/" + name_ + "/costmap", {.durability = rtps::Durability::kTransientLocal, .depth = 1});
    if (!grid) return Error{grid.error()};
    grid_.emplace(std::move(*grid));
    node_->trigger(ros2::TransitionId::kConfigure);
    return {};
  }
  void activate() {
    node_->trigger(ros2::TransitionId::kActivate);
    timer_.emplace(node_->node().context().executor(), period_, [this] {
      if (const auto grid = draw_()) grid_->publish(*grid);
    });
  }
  void deactivate() {
    timer_.reset();
    node_->trigger(ros2::TransitionId::kDeactivate);
  }

 private:
  const std::string name_;
  const Duration period_;
  const std::function<std::optional<msg::OccupancyGrid>()> draw_;
  std::unique_ptr<ros2::LifecycleNode> node_;
  std::optional<ros2::Publisher<msg::OccupancyGrid>> grid_;
  std::optional<ros2::Timer> timer_;
};

// The costs of a window of cells, as a costmap shows them.
inline msg::OccupancyGrid draw_costs(const CostGrid& costs, int width, int height) {
  msg::OccupancyGrid grid;
  grid.header = header_now("map");
  grid.info.resolution = static_cast<float>(GridMap::kResolution);
  grid.info.width = static_cast<std::uint32_t>(width);
  grid.info.height = static_cast<std::uint32_t>(height);
  for (int i = 0; i < width * height; ++i)
    grid.data.push_back(static_cast<std::int8_t>(costs.at(i % width, i / width)));
  return grid;
}

// Where the beams of a scan end that hit something within `reach`, seen from `robot`.
inline std::vector<Pose2> obstacles_in(const msg::LaserScan& scan, const Pose2& robot,
                                       double reach) {
  std::vector<Pose2> points;
  double angle = static_cast<double>(scan.angle_min);
  for (const float range : scan.ranges) {
    if (range > scan.range_min && static_cast<double>(range) < reach)
      points.push_back(robot * Pose2{0, 0, angle} * Pose2{static_cast<double>(range), 0, 0});
    angle += static_cast<double>(scan.angle_increment);
  }
  return points;
}

}  // namespace culprit::rover
