// Positions of things, and goals of the vehicle.
//
// The frame is the simulation's: metres, x and y level, z up, the surface of the water at 0.
#pragma once

#include <cmath>

namespace culprit::suave::model {

struct Position {
  double x = 0;
  double y = 0;
  double z = 0;
};

inline constexpr double kSeabed = -20;  // z

// Whether both are within `tolerance` on x and on y, the exemplar's way to say "reached".
inline bool is_near(const Position& a, const Position& b, double tolerance) {
  return std::abs(a.x - b.x) <= tolerance && std::abs(a.y - b.y) <= tolerance;
}

// The tangent of half the camera's field of view, 60 degrees: how much of the ground it sees to
// each side, per metre above it.
inline const double kSeenPerMetre = 1 / std::sqrt(3.0);

}  // namespace culprit::suave::model
