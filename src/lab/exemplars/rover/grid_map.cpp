#include "exemplars/rover/grid_map.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace culprit::rover {
namespace {

// Half a metre a letter, the highest row first. The furniture makes no two rooms alike: a particle filter would mix them up.
constexpr std::array<std::string_view, 16> kHouse = {"########################",  //
                                                     "#......#.......#.....###",  //
                                                     "#.##...#.......#.......#",  //
                                                     "#......#..#....#.......#",  //
                                                     "#..............#.......#",  //
                                                     "#......#.......#..##...#",  //
                                                     "#......#.......#.......#",  //
                                                     "####..######..#####..###",  //
                                                     "#......................#",  //
                                                     "#......................#",  //
                                                     "#......................#",  //
                                                     "###..#####..#######..###",  //
                                                     "#......#.......#.......#",  //
                                                     "#......#...#...#.......#",  //
                                                     "##.....#.......#...#...#",  //
                                                     "########################"};
constexpr int kCellsPerLetter = 5;

}  // namespace

GridMap::GridMap(int width, int height)
    : width_(width), height_(height), walls_(static_cast<std::size_t>(width * height), false) {}

GridMap GridMap::house() {
  GridMap map(static_cast<int>(kHouse.front().size()) * kCellsPerLetter,
              static_cast<int>(kHouse.size()) * kCellsPerLetter);
  for (int row = 0; row < map.height_; ++row) {
    const auto& letters =
        kHouse[kHouse.size() - 1 - static_cast<std::size_t>(row / kCellsPerLetter)];
    for (int column = 0; column < map.width_; ++column) {
      if (letters[static_cast<std::size_t>(column / kCellsPerLetter)] == '#')
        map.set_wall(column, row);
    }
  }
  return map;
}

double GridMap::ray(const Pose2& from, double longest) const {
  constexpr double kStep = kResolution / 2;
  const double dx = std::cos(from.yaw) * kStep;
  const double dy = std::sin(from.yaw) * kStep;
  double x = from.x;
  double y = from.y;
  for (double length = 0; length < longest; length += kStep, x += dx, y += dy) {
    if (is_wall_at(x, y)) return length;
  }
  return longest;
}

// Two passes of a chamfer transform.
std::vector<float> GridMap::distances(double most) const {
  const auto step = static_cast<float>(kResolution);
  const float diagonal = step * std::numbers::sqrt2_v<float>;
  std::vector<float> all(walls_.size(), static_cast<float>(most));
  const auto relax = [&](int column, int row, int from_column, int from_row, float cost) {
    float& here = all[index(column, row)];
    const bool is_outside =
        from_column < 0 || from_row < 0 || from_column >= width_ || from_row >= height_;
    here = std::min(here, cost + (is_outside ? 0 : all[index(from_column, from_row)]));
  };
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      if (is_wall(column, row)) all[index(column, row)] = 0;
      relax(column, row, column - 1, row, step);
      relax(column, row, column, row - 1, step);
      relax(column, row, column - 1, row - 1, diagonal);
      relax(column, row, column + 1, row - 1, diagonal);
    }
  }
  for (int row = height_ - 1; row >= 0; --row) {
    for (int column = width_ - 1; column >= 0; --column) {
      relax(column, row, column + 1, row, step);
      relax(column, row, column, row + 1, step);
      relax(column, row, column + 1, row + 1, diagonal);
      relax(column, row, column - 1, row + 1, diagonal);
    }
  }
  return all;
}

msg::OccupancyGrid GridMap::to_message() const {
  msg::OccupancyGrid message;
  message.header = header_now("map");
  message.info.resolution = static_cast<float>(kResolution);
  message.info.width = static_cast<std::uint32_t>(width_);
  message.info.height = static_cast<std::uint32_t>(height_);
  for (const bool wall : walls_) message.data.push_back(wall ? 100 : 0);
  return message;
}

GridMap GridMap::from_message(const msg::OccupancyGrid& message) {
  GridMap map(static_cast<int>(message.info.width), static_cast<int>(message.info.height));
  const std::size_t cells = std::min(map.walls_.size(), message.data.size());
  for (std::size_t i = 0; i < cells; ++i) map.walls_[i] = message.data[i] > 50;
  return map;
}

}  // namespace culprit::rover
