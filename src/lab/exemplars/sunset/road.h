// A town's roads and what stands or drives on them.
#pragma once

#include <cstdint>

#include "exemplars/sunset/camera.h"
#include "exemplars/sunset/image.h"

namespace culprit::sunset {

enum class Axis : std::uint8_t { kX, kY };

inline constexpr double kLaneMetres = 3.4;

// Runs along `axis` through the whole terrain; `centre` is its coordinate on the other axis.
// Traffic keeps right.
struct Road {
  Axis axis = Axis::kX;
  double centre = 0;          // metres
  double half_width = 0;      // metres, asphalt only
  int lanes = 1;              // for each direction
  bool kerb_parking = false;  // along both sides
};

struct Vehicle {
  Point centre;         // metres on the terrain
  Point front{1, 0};    // the unit vector to its front
  double length = 4.5;  // metres
  double width = 1.9;
  double height = 1.5;
  Rgb colour;
};

}  // namespace culprit::sunset
