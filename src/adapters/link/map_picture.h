// The content of a map view: a map, the robot on it, its path, and the hits of its laser. Bounded in size, whatever the messages
// claim.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "link/frame_tree.h"

namespace culprit::link {

struct GridPicture {
  static constexpr std::uint32_t kMostCells =
      512;  // in a row or column; larger maps are drawn coarser

  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double resolution = 0;        // m a cell
  std::uint32_t coarser = 1;    // how many cells of the message are one of these, in each direction
  ros2::msg::Transform origin;  // of the corner of the first cell, in the map's frame
  // Row by row: '0' free to '9' occupied, '?' unknown. A cell is as occupied as the most occupied one that it stands for.
  std::string cells;
};
// Errors: the message contradicts itself, or has no area.
Expected<GridPicture> picture_of(const ros2::msg::OccupancyGrid& grid);

struct PlanePoint {
  double x = 0;  // m, in the map's frame
  double y = 0;
};
inline constexpr std::size_t kMostPoints =
    720;  // of a path or scan; of longer ones every n-th is drawn
// `place`: that of the message's frame in the map's. The last pose is always among them.
std::vector<PlanePoint> points_of(const ros2::msg::Path& path, const ros2::msg::Transform& place);
// Where its beams hit something.
std::vector<PlanePoint> points_of(const ros2::msg::LaserScan& scan,
                                  const ros2::msg::Transform& place);

struct MapPicture {
  struct Robot {
    std::string frame;
    PlanePoint at;
    double yaw = 0;  // rad
    Duration age{};  // how long ago the newest transforms arrived
  };
  struct Line {
    std::string topic;
    std::vector<PlanePoint> points;
    Duration age{};
  };
  std::vector<std::string> topics;  // that have a map, the usual one first
  std::string topic;                // of the drawn one; empty: none is known
  std::string frame;
  std::uint64_t number = 0;         // of its message; 0: none has come
  std::optional<GridPicture> grid;  // nothing: the asker has this number
  std::vector<Robot> robots;
  std::optional<Line> path;
  std::optional<Line> scan;
  std::vector<std::string> troubles;  // sentences about the parts that are not drawn
};

}  // namespace culprit::link
