// How the vehicle moves: kinematics that stand for a BlueROV2 under ArduSub.
//
// It heads for its setpoint with a speed proportional to the distance, up to a cruise speed, with a
// lag; its depth does the same. Its own estimate of the position, and its camera's, is off by an
// Ornstein-Uhlenbeck process. A failed thruster makes it slower and less agile.
//
// The constants are not the exemplar's, which are hidden in an autopilot; they are fitted to what
// the published runs took (scripts/fit-suave).
#pragma once

#include <array>

#include "base/units.h"
#include "exemplars/suave/model/position.h"
#include "simulation/random.h"

namespace culprit::suave::model {

inline constexpr int kThrusters = 6;

struct VehicleTraits {
  double gain_per_s = 0.65;     // speed per distance to the setpoint
  double cruise = 0.7625;       // m/s, level
  double climb = 0.11;          // m/s
  double lag_s = 0.5;           // of the speed behind what is wanted
  double drift_sd = 0.06;       // m, of the position that is seen, on each axis
  double drift_time_s = 3;      // how long it remembers
  double failed_speed = 0.395;  // of the cruise speed, with one thruster failed
  double failed_gain = 0.70;
  double failed_again = 0.6;  // of the speed, for each further one

  // Where the search begins: the drift between the simulation's frame and the autopilot's.
  double centre_y = 2.35;
  double centre_y_sd = 0.25;
  double first_pose_s = 6.625;  // of the autopilot, after the mission's begin

  bool operator==(const VehicleTraits&) const = default;
};

class Vehicle {
 public:
  static constexpr Duration kStep = std::chrono::milliseconds(50);  // 20 Hz, as poses are published

  Vehicle(const VehicleTraits& traits, const Position& start, simulation::Random random);

  void go_to(const Position& goal) { goal_ = goal; }
  void advance();  // by a step

  const Position& position() const { return position_; }
  // The position as the autopilot and the camera estimate it.
  Position seen() const;

  // `thruster` counts from 1.
  void set_failed(int thruster, bool is_failed);
  int failed_thrusters() const;
  // It has no power and moves no more, for good.
  void cut_power() { has_power_ = false; }

 private:
  VehicleTraits traits_;
  simulation::Random random_;
  Position position_;
  Position velocity_;
  Position drift_;  // of standard deviation 1
  Position goal_;
  std::array<bool, kThrusters> failed_{};
  bool has_power_ = true;
};

}  // namespace culprit::suave::model
