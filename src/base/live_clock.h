// The clock of a live robot (base/time.h).
#pragma once

#include "base/time.h"

namespace culprit {

// Monotonic, so that no setting of the wall clock looks like a silence.
Time live_now();

}  // namespace culprit
