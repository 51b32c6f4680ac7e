// Simulates the drone's two cameras: the lens, the noise and the encoding of a healthy sensor.
#pragma once

#include "exemplars/sunset/image.h"
#include "simulation/random.h"

namespace culprit::sunset {

// The colour camera: a lens that mixes neighbouring pixels (standard deviation 0.7 px), and noise
// of 2.2 grey levels.
RgbImage photograph(const RgbImage& view, simulation::Random random);

// The depth camera: the distance along the optical axis to what stands `height` metres above the
// ground, in counts of kDepthMetresPerCount, with noise of 2 counts (3 cm). Bare ground reads 3277.
DepthImage measure_depth(const Image<float>& height, simulation::Random random);

}  // namespace culprit::sunset
