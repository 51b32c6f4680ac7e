#include "exemplars/rover/pure_pursuit.h"

#include <algorithm>

namespace culprit::rover {
namespace {

constexpr double kAhead = 0.5;       // metres along the path
constexpr double kTurnsFirst = 0.9;  // radians
constexpr double kMostTurn = 1.2;    // radians a second

}  // namespace

Command pursue(const std::vector<Pose2>& path, const Pose2& robot, double most) {
  if (path.empty()) return {};
  const auto by_distance = [&](const Pose2& a, const Pose2& b) {
    return distance(a, robot) < distance(b, robot);
  };
  auto ahead = std::ranges::min_element(path, by_distance);
  while (std::next(ahead) != path.end() && distance(*ahead, robot) < kAhead) ++ahead;
  const Pose2 target = inverse(robot) * *ahead;
  const double angle = std::atan2(target.y, target.x);
  if (std::abs(angle) > kTurnsFirst) return {0, std::clamp(2 * angle, -kMostTurn, kMostTurn)};
  const double squared = std::max(target.x * target.x + target.y * target.y, 0.01);
  const double curvature = 2 * target.y / squared;
  const double left = distance(path.back(), robot);
  const double speed = std::min({most, most / (1 + std::abs(curvature) / 2), 0.1 + left});
  return {speed, std::clamp(speed * curvature, -kMostTurn, kMostTurn)};
}

double free_length(const Pose2& robot, const Command& command, double longest,
                   const std::function<bool(const Pose2&)>& is_occupied) {
  if (command.speed <= 0) return longest;
  constexpr double kStep = 0.1;
  Pose2 at = robot;
  for (double length = kStep; length <= longest; length += kStep) {
    at = moved(at, command.speed, command.turn, kStep / command.speed);
    if (is_occupied(at)) return length - kStep;
  }
  return longest;
}

}  // namespace culprit::rover
