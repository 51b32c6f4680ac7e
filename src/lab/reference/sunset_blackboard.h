// The initial content of the reference's blackboard on SUNSET: the constants of its own rule file
// (rules/sunset-reference.rules names the same signals).
#pragma once

#include <map>
#include <string>

#include "base/value.h"

namespace culprit::study {

inline std::map<std::string, Value> sunset_blackboard() {
  return {{"segmentation_entropy", 0.0}, {"depth_camera_freq", 2.0},
          {"rgb_camera_freq", 2.0},      {"segmentation_freq", 2.0},
          {"sensors_fused_freq", 2.0},   {"camera_autofocus_needed", false}};
}

}  // namespace culprit::study
