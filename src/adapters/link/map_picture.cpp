#include "link/map_picture.h"

#include <algorithm>
#include <cmath>

namespace culprit::link {
namespace {

constexpr std::int8_t kUnknown = -1;

char letter_of(std::int8_t cell) {
  if (cell < 0) return '?';
  return static_cast<char>('0' + 9 * std::min<int>(cell, 100) / 100);
}

// The most occupied cell of a square of the message.
std::int8_t most_occupied(const ros2::msg::OccupancyGrid& grid, std::size_t column, std::size_t row,
                          std::size_t side) {
  std::int8_t most = kUnknown;
  const std::size_t last_row = std::min<std::size_t>(row + side, grid.info.height);
  const std::size_t last_column = std::min<std::size_t>(column + side, grid.info.width);
  for (std::size_t r = row; r < last_row; ++r) {
    const auto* begin = grid.data.data() + r * grid.info.width;
    most = std::max(most, *std::max_element(begin + column, begin + last_column));
  }
  return most;
}

// Every n-th, so that no more than kMostPoints are left.
std::size_t stride_of(std::size_t count) { return count / (kMostPoints + 1) + 1; }

bool is_finite(const ros2::msg::Vector3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Expected<GridPicture> picture_of(const ros2::msg::OccupancyGrid& grid) {
  if (grid.header.frame_id.size() > FrameTree::kLongestName)
    return Error{"the name of its frame is too long"};
  const auto& [time, resolution, width, height, origin] = grid.info;
  const std::string size = std::to_string(width) + " × " + std::to_string(height);
  if (grid.data.size() != static_cast<std::size_t>(width) * height)
    return Error{"it claims " + size + " cells, and has " + std::to_string(grid.data.size())};
  if (grid.data.empty()) return Error{"it has no cells"};
  if (!(resolution > 0) || !std::isfinite(resolution)) return Error{"its cells have no size"};
  GridPicture picture;
  picture.origin = {{origin.position.x, origin.position.y, origin.position.z}, origin.orientation};
  if (!is_valid(picture.origin)) return Error{"its origin is no place"};
  const std::uint32_t longest = std::max(width, height);
  picture.coarser = (longest - 1) / GridPicture::kMostCells + 1;
  picture.resolution = static_cast<double>(resolution) * picture.coarser;
  picture.width = (width - 1) / picture.coarser + 1;
  picture.height = (height - 1) / picture.coarser + 1;
  picture.cells.reserve(static_cast<std::size_t>(picture.width) * picture.height);
  for (std::size_t row = 0; row < height; row += picture.coarser) {
    for (std::size_t column = 0; column < width; column += picture.coarser)
      picture.cells += letter_of(most_occupied(grid, column, row, picture.coarser));
  }
  return picture;
}

std::vector<PlanePoint> points_of(const ros2::msg::Path& path, const ros2::msg::Transform& place) {
  std::vector<PlanePoint> points;
  const std::size_t count = path.poses.size();
  const auto add = [&](std::size_t i) {
    const ros2::msg::Point& at = path.poses[i].pose.position;
    const ros2::msg::Vector3 on_map = moved_by(place, {at.x, at.y, at.z});
    if (is_finite(on_map)) points.push_back({on_map.x, on_map.y});
  };
  const std::size_t stride = stride_of(count);
  for (std::size_t i = 0; i + 1 < count; i += stride) add(i);
  if (count > 0) add(count - 1);
  return points;
}

std::vector<PlanePoint> points_of(const ros2::msg::LaserScan& scan,
                                  const ros2::msg::Transform& place) {
  std::vector<PlanePoint> points;
  const std::size_t stride = stride_of(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); i += stride) {
    const auto range = static_cast<double>(scan.ranges[i]);
    const bool hits = range >= static_cast<double>(scan.range_min) &&
                      range < static_cast<double>(scan.range_max);  // false for NaN
    const double angle = static_cast<double>(scan.angle_min) +
                         static_cast<double>(i) * static_cast<double>(scan.angle_increment);
    const ros2::msg::Vector3 on_map =
        moved_by(place, {range * std::cos(angle), range * std::sin(angle), 0});
    if (hits && is_finite(on_map)) points.push_back({on_map.x, on_map.y});
  }
  return points;
}

}  // namespace culprit::link
