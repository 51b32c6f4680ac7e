// Paints one block of a town: the area between the roads.
#pragma once

#include <vector>

#include "exemplars/sunset/brush.h"
#include "exemplars/sunset/road.h"
#include "simulation/random.h"

namespace culprit::sunset {

// Paints `area` as one of five kinds, drawn at random; cars on parking lots are added to `parked`.
void paint_block(Terrain& terrain, Rect area, simulation::Random& random,
                 std::vector<Vehicle>& parked);

}  // namespace culprit::sunset
