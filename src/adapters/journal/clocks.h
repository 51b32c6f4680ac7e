// One moment on both clocks that records which outlive a process are dated with.
//
// The robot's clock is reliable, but restarts whenever the machine does. The wall clock goes on,
// but jumps: a computer without a battery begins in 1970 until it gets the time from the network.
#pragma once

#include <cstdint>
#include <string>

#include "base/time.h"

namespace culprit::journal {

struct Clocks {
  std::string boot;  // which start of the machine (boot_id(), session.h)
  Time robot;
  std::int64_t wall = 0;     // nanoseconds since 1970
  bool is_wall_set = false;  // the kernel holds the wall clock to be synchronised
};

// `robot`: now, on the robot's clock.
Clocks clocks_now(Time robot);

// How long ago `then` was, as far as that is certain: less if the clocks do not show it.
Duration certain_age(const Clocks& then, const Clocks& now);

}  // namespace culprit::journal
