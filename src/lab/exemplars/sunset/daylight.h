// Turns a painted terrain into one that looks sunlit: cast shadows, shaded slopes, and the grain of
// each material.
//
// The sun stands in the map's upper left (towards -x, -y), 50 degrees high.
#pragma once

#include <cstdint>

#include "exemplars/sunset/image.h"
#include "exemplars/sunset/terrain.h"

namespace culprit::sunset {

// Changes every cell's colour and `sunlit`; to be called once, after painting.
void light(Terrain& terrain, std::uint64_t seed);

// The colour of a surface in shadow: darker, and bluish from the sky.
Rgb in_shadow(Rgb colour);

}  // namespace culprit::sunset
