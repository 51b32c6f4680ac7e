// The clocks of this machine.
#pragma once

#include <cstdint>

#include "base/time.h"

namespace culprit {

// The clock of a live robot (base/time.h): monotonic, so that no setting of the wall clock looks
// like a silence.
Time live_now();

// The wall clock's time, in nanoseconds since 1970 (UTC).
std::int64_t wall_now();

}  // namespace culprit
