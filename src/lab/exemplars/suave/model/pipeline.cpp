#include "exemplars/suave/model/pipeline.h"

namespace culprit::suave::model {
namespace {

constexpr std::size_t kPointsPerSegment = 20;
constexpr std::array<Position, kPipelinePoints / kPointsPerSegment + 1> kJoints = {
    {{-15, 0, kSeabed},
     {-25, 0, kSeabed},
     {-35, 0, kSeabed},
     {-37.41, -1.00, kSeabed},
     {-44.49, -8.07, kSeabed},
     {-51.56, -15.14, kSeabed}}};

std::array<Position, kPipelinePoints> interpolated() {
  std::array<Position, kPipelinePoints> points;
  for (std::size_t i = 0; i < kPipelinePoints; ++i) {
    const Position& from = kJoints[i / kPointsPerSegment];
    const Position& to = kJoints[i / kPointsPerSegment + 1];
    const double share = static_cast<double>(i % kPointsPerSegment + 1) / kPointsPerSegment;
    points[i] = {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), kSeabed};
  }
  return points;
}

}  // namespace

const std::array<Position, kPipelinePoints>& pipeline() {
  static const std::array<Position, kPipelinePoints> kPoints = interpolated();
  return kPoints;
}

std::optional<std::size_t> seen_point(const Position& camera, double height, double visibility) {
  const double above = std::abs(camera.z - (kSeabed + height));
  if (above > visibility) return std::nullopt;
  const double reach = above * kSeenPerMetre;
  const auto& points = pipeline();
  for (std::size_t i = 0; i < kPipelinePoints; ++i) {
    if (is_near(points[i], camera, reach)) return i;
  }
  return std::nullopt;
}

std::vector<Position> inspection_path(std::size_t first) {
  const auto& points = pipeline();
  std::vector<Position> path(points.begin() + static_cast<std::ptrdiff_t>(first), points.end());
  path.insert(path.end(), points.rbegin(), points.rend());
  return path;
}

}  // namespace culprit::suave::model
