// The content of a modelled topic: of a picture, only the properties that determine the
// segmentation's entropy.
#pragma once

#include <string>
#include <vector>

#include "base/units.h"
#include "base/value.h"

namespace culprit::sunset::model {

// Of the camera.
inline constexpr Duration kFramePeriod = std::chrono::milliseconds(100);

struct Frame {
  Duration stamp{};       // in the bag
  double brightness = 1;  // factor on the pixels; 0.25 is degraded, 4 is washed out
  int shift = 0;          // columns to the right
  double noise = 0;       // depth_degradation
};

inline Duration stamp_of(const Frame& frame) { return frame.stamp; }

// One status on /diagnostics: values that came since the last one.
struct Heartbeat {
  std::string node;  // its name without the namespace: the hardware id
  std::vector<std::pair<std::string, Value>> values;
};

}  // namespace culprit::sunset::model
