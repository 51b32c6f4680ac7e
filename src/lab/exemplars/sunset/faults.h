// SUNSET's faults and adaptations as far as they touch pixels, with its parameters' names and
// scenario values. Each is the node's effect on one frame; none of them is reported.
#pragma once

#include <cstdint>

#include "exemplars/sunset/image.h"

namespace culprit::sunset {

// camera, image_degradation: pixels * (1 - 0.5 * amount). The scenario's 1.5 leaves a quarter of
// the light; 0 is the identity.
RgbImage degrade(const RgbImage& rgb, double image_degradation);

// image_enhancement, image_degradation: pixels * (1 + 2 * amount), cast to 8 bits without clipping
// as in the original. At 1.5 it multiplies by four: it undoes degrade(1.5) but for the two lowest
// bits, and wraps the bright pixels of a healthy picture around into noise.
RgbImage enhance(const RgbImage& rgb, double image_degradation = 1.5);

// sensor_fusion, image_shift: moves the picture to the right and fills with black. Columns are
// counted in the exemplar's pictures, 1920 wide, and scaled to this one: the scenario's 300 move a
// picture of 160 columns by 25. Not above 0 is the identity.
RgbImage shift(const RgbImage& rgb, std::int64_t image_shift);
inline constexpr std::int64_t kExemplarWidth = 1920;

// depth, depth_degradation: adds 16 * g * (N(0, 1) - 0.5) counts to each pixel and wraps at 16
// bits. The noise is a pure function of `seed`. Our depth has the exemplar's unit
// (kDepthMetresPerCount), so its formula needs no scaling: the scenario's 2.0 is a standard
// deviation of 0.49 m and 0.24 m too near.
DepthImage depth_noise(const DepthImage& depth, double depth_degradation, std::uint64_t seed);

// camera, autofocus_needed: a Gaussian blur of sigma 1 pixel (binomial kernel 1 4 6 4 1), mild.
RgbImage defocus(const RgbImage& rgb);

}  // namespace culprit::sunset
