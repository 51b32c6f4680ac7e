// Places in the plane: metres and radians, and how they are written in messages.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "exemplars/rover/messages.h"

namespace culprit::rover {

struct Pose2 {
  double x = 0;
  double y = 0;
  double yaw = 0;
};

// In (-pi, pi].
inline double normalized(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

// The pose `b`, which is given in the frame of `a`, in the frame that `a` is given in.
inline Pose2 operator*(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.yaw);
  const double s = std::sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, normalized(a.yaw + b.yaw)};
}

inline Pose2 inverse(const Pose2& a) {
  const double c = std::cos(a.yaw);
  const double s = std::sin(a.yaw);
  return {-c * a.x - s * a.y, s * a.x - c * a.y, -a.yaw};
}

inline double distance(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// After `dt` seconds at a constant speed and turn rate.
inline Pose2 moved(const Pose2& from, double speed, double turn, double dt) {
  const double yaw = from.yaw + turn * dt / 2;
  return {from.x + speed * dt * std::cos(yaw), from.y + speed * dt * std::sin(yaw),
          normalized(from.yaw + turn * dt)};
}

// Nearly normal, with standard deviation 1: a sum of uniform draws, for std::normal_distribution differs between standard libraries.
inline double noise(std::mt19937_64& random) {
  double sum = -2;
  for (int i = 0; i < 4; ++i) sum += static_cast<double>(random() >> 11) * 0x1p-53;
  return sum * std::numbers::sqrt3;
}

inline msg::Quaternion quaternion(double yaw) {
  return {0, 0, std::sin(yaw / 2), std::cos(yaw / 2)};
}
inline double yaw_of(const msg::Quaternion& q) { return 2 * std::atan2(q.z, q.w); }

inline msg::Pose to_message(const Pose2& pose) {
  return {{pose.x, pose.y, 0}, quaternion(pose.yaw)};
}
inline Pose2 to_pose(const msg::Pose& pose) {
  return {pose.position.x, pose.position.y, yaw_of(pose.orientation)};
}
inline msg::Twist to_twist(double speed, double turn) { return {{speed, 0, 0}, {0, 0, turn}}; }

inline msg::Header header_now(std::string frame) {
  return {ros2::msg::to_time(std::chrono::system_clock::now()), std::move(frame)};
}

inline msg::TFMessage to_tf(msg::Header header, std::string child, const Pose2& pose) {
  return {{{std::move(header), std::move(child), {{pose.x, pose.y, 0}, quaternion(pose.yaw)}}}};
}

}  // namespace culprit::rover
