// The drone's view: a picture, its depth and its ground truth for every frame, derived from one
// town.
//
// The drone flies 50 m above the ground along a gently swaying line, its camera looking straight
// down, 10 frames a second (the rate of the exemplar's bag); vehicles drive below it. Everything is
// a pure function of the seed and the frame's number, so nodes that share a seed see the same
// flight without sharing anything else.
#pragma once

#include <cstdint>

#include "exemplars/sunset/camera.h"
#include "exemplars/sunset/image.h"
#include "exemplars/sunset/town.h"

namespace culprit::sunset {

inline constexpr double kFramePeriodSec = 0.1;

struct Frame {
  RgbImage rgb;
  DepthImage depth;
  LabelImage truth;
};

class Scene {
 public:
  // Builds the town: some 20 ms and 6 MB.
  explicit Scene(std::uint64_t seed, Size size = {});

  // Thread-safe.
  Frame frame(std::uint64_t number) const;

  // Moves by about 0.6 m and turns by less than a degree from one frame to the next, but for jumps
  // by the terrain's period, which look like nothing.
  Pose pose(std::uint64_t number) const;

 private:
  std::uint64_t seed_;
  Size size_;
  Town town_;
};

}  // namespace culprit::sunset
