// The world of the rover, as a simulation of physics: a house, people who walk in it, and the rover's body with its
// battery. Its nodes see it only through their devices. Deterministic; advanced by step().
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "exemplars/rover/grid_map.h"

namespace culprit::rover {

class World {
 public:
  static constexpr double kRobotRadius = 0.2;
  static constexpr double kPersonRadius = 0.25;
  static constexpr double kLidarRange = 6;
  static constexpr int kBeams = 90;
  static constexpr Pose2 kStart{6, 3.25, 0};  // in the corridor

  explicit World(std::uint64_t seed);

  // By how far the body obeys a command is up to walls: a robot that would touch one stands still.
  void drive(double speed, double turn);
  void step(double dt);

  const GridMap& map() const { return map_; }
  const Pose2& robot() const { return robot_; }
  double speed() const { return speed_; }
  double turn() const { return turn_; }
  const std::vector<Pose2>& people() const { return people_; }
  double battery() const { return battery_; }  // 0 to 1
  double driven() const { return driven_; }    // metres
  int collisions() const { return collisions_; }
  // As the lidar measures them: from -pi on, counter-clockwise, with noise.
  std::vector<float> scan();

  // Somebody lifts the robot and puts it down elsewhere.
  void kidnap(const Pose2& to) { robot_ = to; }
  void set_battery(double charge) { battery_ = charge; }
  bool is_free(const Pose2& pose) const;

 private:
  void walk(double dt);

  GridMap map_ = GridMap::house();
  std::vector<float> clearance_;
  std::mt19937_64 random_;
  Pose2 robot_ = kStart;
  double speed_ = 0;
  double turn_ = 0;
  double battery_ = 1;
  double driven_ = 0;
  int collisions_ = 0;
  bool touches_ = false;
  std::vector<Pose2> people_;
};

}  // namespace culprit::rover
