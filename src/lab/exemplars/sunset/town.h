// A made-up town: its map, its roads and the cars that are parked in it. A pure function of the
// seed.
//
// Roads cross the torus from edge to edge along both axes and leave blocks between them; each block
// is houses with gardens, apartment buildings, a commercial lot, a park, or a building site. A
// canal runs along one road.
#pragma once

#include <cstdint>
#include <vector>

#include "exemplars/sunset/image.h"
#include "exemplars/sunset/road.h"
#include "exemplars/sunset/terrain.h"

namespace culprit::sunset {

struct Town {
  Terrain terrain;
  std::vector<Road> roads;
  std::vector<Vehicle> parked;
};

Town build_town(std::uint64_t seed);

}  // namespace culprit::sunset
