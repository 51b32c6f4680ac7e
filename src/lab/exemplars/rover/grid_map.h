// The rover's house as a grid of cells: walls, doors and furniture. Everything outside is wall.
#pragma once

#include <vector>

#include "exemplars/rover/geometry.h"

namespace culprit::rover {

class GridMap {
 public:
  static constexpr double kResolution = 0.1;  // metres a cell

  // Six rooms around a corridor, 12 m by 8 m; (0, 0) is the lower left corner.
  static GridMap house();
  // An empty map of so many cells.
  GridMap(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int size() const { return width_ * height_; }
  bool is_wall(int column, int row) const {
    return column < 0 || row < 0 || column >= width_ || row >= height_ ||
           walls_[index(column, row)];
  }
  bool is_wall_at(double x, double y) const { return is_wall(cell(x), cell(y)); }
  void set_wall(int column, int row) { walls_[index(column, row)] = true; }

  static int cell(double metres) { return static_cast<int>(std::floor(metres / kResolution)); }
  static double centre(int cell) { return (cell + 0.5) * kResolution; }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }

  // Metres from (x, y) to the first wall in a direction, at most `longest`. Exact to half a cell.
  double ray(const Pose2& from, double longest) const;

  // For each cell the distance in metres to the nearest wall, at most `most`.
  std::vector<float> distances(double most) const;

  msg::OccupancyGrid to_message() const;
  static GridMap from_message(const msg::OccupancyGrid& message);

 private:
  int width_;
  int height_;
  std::vector<bool> walls_;  // row by row, from the lowest
};

}  // namespace culprit::rover
