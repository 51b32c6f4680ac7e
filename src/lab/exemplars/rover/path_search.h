// A*: the cheapest path of a disc on a grid of costs.
#pragma once

#include <vector>

#include "exemplars/rover/grid_map.h"

namespace culprit::rover {

// The cost of each cell: kLethal within the robot's radius of an obstacle, less and less beyond.
class CostGrid {
 public:
  static constexpr int kLethal = 100;

  // `points` are further obstacles, in metres on the map.
  CostGrid(const GridMap& map, const std::vector<Pose2>& points);

  int at(int column, int row) const;
  int at(const Pose2& pose) const { return at(GridMap::cell(pose.x), GridMap::cell(pose.y)); }
  const GridMap& map() const { return map_; }

 private:
  GridMap map_;
  std::vector<float> clearance_;
};

// Poses a cell apart from start to goal, each looking at the next. Empty: there is no path. A start that is too near to an
// obstacle is left on the shortest way out.
std::vector<Pose2> search_path(const CostGrid& costs, const Pose2& start, const Pose2& goal);

}  // namespace culprit::rover
