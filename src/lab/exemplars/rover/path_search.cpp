#include "exemplars/rover/path_search.h"

#include <algorithm>
#include <array>
#include <limits>
#include <queue>

#include "exemplars/rover/world.h"

namespace culprit::rover {
namespace {

constexpr double kInflation = 0.55;  // metres from an obstacle, beyond which all cells cost nothing

GridMap with_points(const GridMap& map, const std::vector<Pose2>& points) {
  GridMap all = map;
  for (const Pose2& point : points) {
    const int column = GridMap::cell(point.x);
    const int row = GridMap::cell(point.y);
    if (!all.is_wall(column, row)) all.set_wall(column, row);
  }
  return all;
}

struct Step {
  float estimate;  // of the whole path through this cell
  int cell;
  bool operator<(const Step& other) const { return estimate > other.estimate; }
};

}  // namespace

CostGrid::CostGrid(const GridMap& map, const std::vector<Pose2>& points)
    : map_(with_points(map, points)), clearance_(map_.distances(kInflation)) {}

int CostGrid::at(int column, int row) const {
  if (map_.is_wall(column, row)) return kLethal;
  const auto clearance = static_cast<double>(clearance_[map_.index(column, row)]);
  if (clearance <= World::kRobotRadius) return kLethal;
  return static_cast<int>(50 * (kInflation - clearance) / (kInflation - World::kRobotRadius));
}

std::vector<Pose2> search_path(const CostGrid& costs, const Pose2& start, const Pose2& goal) {
  const GridMap& map = costs.map();
  const auto cell_of = [&](int column, int row) { return row * map.width() + column; };
  const int goal_column = GridMap::cell(goal.x);
  const int goal_row = GridMap::cell(goal.y);
  if (costs.at(goal) >= CostGrid::kLethal || map.is_wall_at(start.x, start.y)) return {};
  const int first = cell_of(GridMap::cell(start.x), GridMap::cell(start.y));
  const int last = cell_of(goal_column, goal_row);

  std::vector<float> best(static_cast<std::size_t>(map.size()), std::numeric_limits<float>::max());
  std::vector<int> from(best.size(), -1);
  std::priority_queue<Step> open;
  best[static_cast<std::size_t>(first)] = 0;
  open.push({0, first});
  while (!open.empty() && open.top().cell != last) {
    const int cell = open.top().cell;
    open.pop();
    const int column = cell % map.width();
    const int row = cell / map.width();
    const bool is_out = costs.at(column, row) < CostGrid::kLethal;
    for (int dc = -1; dc <= 1; ++dc) {
      for (int dr = -1; dr <= 1; ++dr) {
        if ((dc == 0 && dr == 0) || map.is_wall(column + dc, row + dr)) continue;
        const int cost = costs.at(column + dc, row + dr);
        if (cost >= CostGrid::kLethal && is_out) continue;
        const float length = dc != 0 && dr != 0 ? std::numbers::sqrt2_v<float> : 1;
        const float total =
            best[static_cast<std::size_t>(cell)] + length * (1 + static_cast<float>(cost) / 20);
        const int next = cell_of(column + dc, row + dr);
        if (total >= best[static_cast<std::size_t>(next)]) continue;
        best[static_cast<std::size_t>(next)] = total;
        from[static_cast<std::size_t>(next)] = cell;
        const double left = std::hypot(column + dc - goal_column, row + dr - goal_row);
        open.push({total + static_cast<float>(left), next});
      }
    }
  }
  if (open.empty()) return {};
  std::vector<Pose2> path = {goal};
  for (int cell = last; cell != first && cell >= 0; cell = from[static_cast<std::size_t>(cell)]) {
    const Pose2 here{GridMap::centre(cell % map.width()), GridMap::centre(cell / map.width()), 0};
    path.push_back({here.x, here.y, std::atan2(path.back().y - here.y, path.back().x - here.x)});
  }
  std::ranges::reverse(path);
  return path;
}

}  // namespace culprit::rover
