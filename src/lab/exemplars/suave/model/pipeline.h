// The pipeline on the seabed: where it lies, from where it is seen, and the path along it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "exemplars/suave/model/position.h"

namespace culprit::suave::model {

inline constexpr std::size_t kPipelinePoints = 100;

// From the end near the vehicle's start on; z is the seabed.
const std::array<Position, kPipelinePoints>& pipeline();

// The first point that the camera sees from `camera`, if the water lets it: at most `visibility`
// metres above the point. `height` is how far above the seabed the pipeline is taken to be.
std::optional<std::size_t> seen_point(const Position& camera, double height, double visibility);

// From point `first` to the far end and back to the beginning.
std::vector<Position> inspection_path(std::size_t first);

}  // namespace culprit::suave::model
