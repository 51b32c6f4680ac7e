#include "exemplars/sunset/scene.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "exemplars/sunset/render.h"
#include "exemplars/sunset/sensor.h"
#include "exemplars/sunset/traffic.h"
#include "simulation/random.h"

namespace culprit::sunset {
namespace {

constexpr double kSpeed = 6.0;  // m/s

// Independent streams of randomness from one seed.
enum class Stream : std::uint64_t { kTown = 1, kTraffic, kFlight, kColourNoise, kDepthNoise };

std::uint64_t stream(std::uint64_t seed, Stream which) {
  return simulation::mix(seed ^ simulation::mix(static_cast<std::uint64_t>(which)));
}

double wrapped(double metres) {
  return metres - kTerrainMetres * std::floor(metres / kTerrainMetres);
}

}  // namespace

Scene::Scene(std::uint64_t seed, Size size)
    : seed_(seed), size_(size), town_(build_town(stream(seed, Stream::kTown))) {}

Pose Scene::pose(std::uint64_t number) const {
  simulation::Random random(stream(seed_, Stream::kFlight));
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double time_sec = static_cast<double>(number) * kFramePeriodSec;
  const double course = random.uniform(0, kTurn);
  const double start_x = random.uniform(0, kTerrainMetres);
  const double start_y = random.uniform(0, kTerrainMetres);
  const double sideways = 5.0 * std::sin(0.23 * time_sec + random.uniform(0, kTurn));
  const double heading = course + 0.25 * std::sin(0.11 * time_sec + random.uniform(0, kTurn));
  const double along = kSpeed * time_sec;
  return {{wrapped(start_x + along * std::cos(course) - sideways * std::sin(course)),
           wrapped(start_y + along * std::sin(course) + sideways * std::cos(course))},
          {std::cos(heading), std::sin(heading)}};
}

Frame Scene::frame(std::uint64_t number) const {
  const Camera camera(pose(number), size_);
  View view = render_terrain(town_.terrain, camera, size_);
  for (const Vehicle& vehicle : town_.parked) {
    render_vehicle(view, town_.terrain, camera, vehicle);
  }
  const double time_sec = static_cast<double>(number) * kFramePeriodSec;
  for (const Vehicle& vehicle :
       moving_vehicles(town_.roads, stream(seed_, Stream::kTraffic), time_sec)) {
    render_vehicle(view, town_.terrain, camera, vehicle);
  }
  return {
      photograph(view.rgb, simulation::Random(stream(seed_, Stream::kColourNoise) + number)),
      measure_depth(view.height, simulation::Random(stream(seed_, Stream::kDepthNoise) + number)),
      std::move(view.truth)};
}

}  // namespace culprit::sunset
