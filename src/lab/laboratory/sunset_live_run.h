// One run of the SUNSET study on the live robot: real processes, real DDS, real pixels, in a world
// of its own that is gone afterwards. It measures the same as on the model.
#pragma once

#include <atomic>

#include "sunset_study/study.h"

namespace culprit::lab {

// Takes about half a minute: until the robot is well, and then as long as a run on the model takes.
// One at a time in a process (demo/sunset_world.h). Errors: the robot does not come up, or does
// something before it is broken; a fault could not be injected; `stop` was set.
Expected<study::RunMetrics> play_live(const study::SunsetStudy& study, study::RunId id,
                                      const std::atomic<bool>& stop);

}  // namespace culprit::lab
