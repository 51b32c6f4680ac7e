#include "exemplars/sunset/traffic.h"

#include <array>
#include <cmath>

#include "exemplars/sunset/terrain.h"

namespace culprit::sunset {
namespace {

// Lengths of road of which each holds one vehicle or none.
constexpr int kSlots = 24;
constexpr double kSlotMetres = kTerrainMetres / kSlots;
constexpr double kOccupied = 0.4;

constexpr std::array kPaints = {Rgb{226, 228, 230}, Rgb{186, 190, 196}, Rgb{122, 126, 134},
                                Rgb{58, 58, 64},    Rgb{178, 44, 42},   Rgb{52, 84, 158},
                                Rgb{212, 178, 52},  Rgb{226, 228, 230}};

void add_lane(std::vector<Vehicle>& vehicles, const Road& road, double offset, double time_sec,
              simulation::Random random) {
  const double direction = offset > 0 ? 1.0 : -1.0;
  const double speed = random.uniform(7.0, 12.0);
  for (int slot = 0; slot < kSlots; ++slot) {
    const bool occupied = random.chance(kOccupied);
    const double place = (slot + random.uniform(0.25, 0.5)) * kSlotMetres;
    Vehicle vehicle = random_vehicle(random);
    if (!occupied) continue;
    const double along = std::fmod(place + direction * speed * time_sec, kTerrainMetres);
    const bool x_axis = road.axis == Axis::kX;
    // The right-hand side of +x is +y, that of +y is -x.
    vehicle.centre =
        x_axis ? Point{along, road.centre + offset} : Point{road.centre - offset, along};
    vehicle.front = x_axis ? Point{direction, 0} : Point{0, direction};
    vehicles.push_back(vehicle);
  }
}

}  // namespace

Vehicle random_vehicle(simulation::Random& random) {
  Vehicle vehicle;
  vehicle.colour = kPaints[static_cast<std::size_t>(random.below(kPaints.size()))];
  vehicle.length = random.uniform(4.0, 4.9);
  vehicle.width = random.uniform(1.8, 2.0);
  vehicle.height = random.uniform(1.4, 1.7);
  if (random.chance(0.125)) {
    vehicle.length = random.uniform(5.5, 8.0);
    vehicle.width = 2.3;
    vehicle.height = random.uniform(2.2, 2.9);
  }
  return vehicle;
}

std::vector<Vehicle> moving_vehicles(const std::vector<Road>& roads, std::uint64_t seed,
                                     double time_sec) {
  std::vector<Vehicle> vehicles;
  simulation::Random seeds(seed);
  for (const Road& road : roads) {
    for (int lane = 0; lane < road.lanes; ++lane) {
      const double offset = (lane + 0.5) * kLaneMetres;
      add_lane(vehicles, road, offset, time_sec, simulation::Random(seeds.next()));
      add_lane(vehicles, road, -offset, time_sec, simulation::Random(seeds.next()));
    }
  }
  return vehicles;
}

}  // namespace culprit::sunset
