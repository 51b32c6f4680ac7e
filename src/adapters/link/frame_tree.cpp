#include "link/frame_tree.h"

#include <algorithm>
#include <cmath>

namespace culprit::link {
namespace {

constexpr int kDeepest = 100;  // a forged tree can be a ring

ros2::msg::Vector3 rotated(const ros2::msg::Quaternion& q, const ros2::msg::Vector3& v) {
  // v + 2 w (q x v) + 2 q x (q x v)
  const ros2::msg::Vector3 t{2 * (q.y * v.z - q.z * v.y), 2 * (q.z * v.x - q.x * v.z),
                             2 * (q.x * v.y - q.y * v.x)};
  return {v.x + q.w * t.x + q.y * t.z - q.z * t.y, v.y + q.w * t.y + q.z * t.x - q.x * t.z,
          v.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

ros2::msg::Quaternion product(const ros2::msg::Quaternion& a, const ros2::msg::Quaternion& b) {
  return {
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

}  // namespace

ros2::msg::Vector3 moved_by(const ros2::msg::Transform& place, const ros2::msg::Vector3& p) {
  const ros2::msg::Vector3 v = rotated(place.rotation, p);
  return {v.x + place.translation.x, v.y + place.translation.y, v.z + place.translation.z};
}

double yaw_of(const ros2::msg::Quaternion& q) {
  return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}

bool is_valid(const ros2::msg::Transform& transform) {
  constexpr double kFarthest = 1e9;  // m
  constexpr double kTolerance = 0.1;
  const auto& [t, q] = transform;
  const double norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  const auto is_near = [](double x) { return std::abs(x) < kFarthest; };  // false for NaN
  return is_near(t.x) && is_near(t.y) && is_near(t.z) && std::abs(norm - 1) < kTolerance;
}

void FrameTree::add(const ros2::msg::TFMessage& message, Kind kind, Time now) {
  for (const ros2::msg::TransformStamped& each : message.transforms) {
    const std::size_t longest = std::max(each.header.frame_id.size(), each.child_frame_id.size());
    if (longest > kLongestName || !is_valid(each.transform)) continue;
    if (edges_.size() >= kMostFrames && !edges_.contains(each.child_frame_id)) continue;
    edges_[each.child_frame_id] = {each.header.frame_id, each.transform,
                                   kind == Kind::kStatic ? std::nullopt : std::optional(now)};
  }
}

std::optional<FrameTree::Placed> FrameTree::place(const std::string& frame,
                                                  const std::string& ancestor, Time now) const {
  Placed placed;
  const std::string* at = &frame;
  for (int depth = 0; *at != ancestor; ++depth) {
    const auto edge = edges_.find(*at);
    if (edge == edges_.end() || depth == kDeepest) return std::nullopt;
    const auto& [parent, transform, arrived] = edge->second;
    placed.transform = {moved_by(transform, placed.transform.translation),
                        product(transform.rotation, placed.transform.rotation)};
    if (arrived) placed.age = std::max(placed.age, now - *arrived);
    at = &parent;
  }
  return placed;
}

std::vector<std::string> FrameTree::called(std::string_view name) const {
  std::vector<std::string> all;
  for (const auto& [frame, edge] : edges_) {
    if (frame.substr(frame.rfind('/') + 1) == name) all.push_back(frame);
  }
  return all;
}

}  // namespace culprit::link
