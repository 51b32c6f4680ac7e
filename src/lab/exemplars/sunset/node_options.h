// How one process of the live robot is started, and the times that SUNSET's nodes take.
//
// Times are robot seconds: those of the exemplar's bag. At speed 1 a robot second is a second on
// the wall, at speed 2 it is half of one. (The exemplar itself plays its bag at 0.2.)
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/units.h"

namespace culprit::sunset {

struct NodeOptions {
  double speed = 1;             // > 0
  std::uint64_t seed = 1;       // of the flight; not 0x5eed0000 to 0x5eed0003 (classifier.h)
  std::filesystem::path state;  // a folder for what outlives a process; empty: nothing does

  Duration wall(double robot_sec) const { return from_seconds(robot_sec / speed); }
};

inline constexpr double kHeartbeatPeriodSec = 0.1;

// The time that a camera, a fusion and a segmentation take to configure, during which they answer
// nothing. In the exemplar it is 1 s on the wall at speed 0.2, that is 0.2 robot seconds. Starting
// Python takes another 2 to 3 s on the wall, which ours do not need. Half a second makes a
// redeployment take as many robot seconds as there, 0.6 to 0.9.
inline constexpr double kConfigureSec = 0.5;

// The time that an unfocused camera takes for each frame. The exemplar's 0.5 s on the wall fill a
// frame period at speed 0.2 and pile up a queue of pictures; three tenths of a period leave the
// rate at 10 Hz.
inline constexpr double kFocusingSec = 0.03;

// From the lifecycle's "finalized" to the end of the process.
inline constexpr double kFarewellSec = 0.1;

}  // namespace culprit::sunset
