#include "exemplars/rover/world.h"

#include <algorithm>

namespace culprit::rover {
namespace {

constexpr double kWalk = 0.35;            // metres a second
constexpr double kKeepsAway = 0.9;        // people turn round that far from the robot
constexpr double kDischarge = 1 / 7200.;  // of the battery, a second
constexpr double kNoise = 0.01;           // metres

// The distance from `from`, looking along its yaw, to a disc; `longest` if it is not hit.
double ray_to_disc(const Pose2& from, const Pose2& centre, double radius, double longest) {
  const double along =
      (centre.x - from.x) * std::cos(from.yaw) + (centre.y - from.y) * std::sin(from.yaw);
  const double aside =
      (centre.x - from.x) * std::sin(from.yaw) - (centre.y - from.y) * std::cos(from.yaw);
  if (along <= 0 || std::abs(aside) >= radius) return longest;
  return std::min(longest, along - std::sqrt(radius * radius - aside * aside));
}

}  // namespace

World::World(std::uint64_t seed)
    : clearance_(map_.distances(1)),
      random_(seed),
      people_{{2, 3.7, 0}, {9.5, 2.7, std::numbers::pi}} {}

void World::drive(double speed, double turn) {
  speed_ = std::clamp(speed, -0.3, 0.6);
  turn_ = std::clamp(turn, -1.5, 1.5);
}

bool World::is_free(const Pose2& pose) const {
  const int column = GridMap::cell(pose.x);
  const int row = GridMap::cell(pose.y);
  if (map_.is_wall(column, row)) return false;
  const bool is_clear =
      static_cast<double>(clearance_[map_.index(column, row)]) >= kRobotRadius - 0.05;
  return is_clear && std::ranges::all_of(people_, [&](const Pose2& person) {
           return distance(person, pose) > kRobotRadius + kPersonRadius - 0.05;
         });
}

void World::step(double dt) {
  walk(dt);
  const Pose2 next = moved(robot_, speed_, turn_, dt);
  const bool is_blocked = !is_free(next) && speed_ != 0;
  if (is_blocked && !touches_ && is_free(robot_)) ++collisions_;
  touches_ = is_blocked;
  // A robot that touches something may turn, and may go where it is farther away.
  const bool goes = !is_blocked || !is_free(robot_);
  driven_ += goes ? std::abs(speed_) * dt : 0;
  robot_ = goes ? next : moved(robot_, 0, turn_, dt);
  battery_ = std::max(0.0, battery_ - kDischarge * dt);
}

void World::walk(double dt) {
  for (Pose2& person : people_) {
    const Pose2 next = moved(person, kWalk, 0, dt);
    const bool sees_robot =
        distance(next, robot_) < kKeepsAway && distance(next, robot_) < distance(person, robot_);
    const bool turns = sees_robot || next.x < 1 || next.x > 11;
    person = turns ? Pose2{person.x, person.y, normalized(person.yaw + std::numbers::pi)} : next;
  }
}

std::vector<float> World::scan() {
  std::vector<float> ranges;
  for (int i = 0; i < kBeams; ++i) {
    const double angle = -std::numbers::pi + 2 * std::numbers::pi * i / kBeams;
    const Pose2 beam{robot_.x, robot_.y, robot_.yaw + angle};
    double range = map_.ray(beam, kLidarRange);
    for (const Pose2& person : people_) range = ray_to_disc(beam, person, kPersonRadius, range);
    ranges.push_back(static_cast<float>(std::max(0.0, range + kNoise * noise(random_))));
  }
  return ranges;
}

}  // namespace culprit::rover
