// The vehicles on a town's roads at a given time.
//
// Every lane is a procession that never ends: its vehicles share one speed and keep their places,
// so the state at any time follows from the seed alone. Processions of crossing roads do not see
// one another.
#pragma once

#include <cstdint>
#include <vector>

#include "exemplars/sunset/road.h"
#include "simulation/random.h"

namespace culprit::sunset {

// A car or, one time in eight, a van or truck, in a colour of its own.
Vehicle random_vehicle(simulation::Random& random);

std::vector<Vehicle> moving_vehicles(const std::vector<Road>& roads, std::uint64_t seed,
                                     double time_sec);

}  // namespace culprit::sunset
