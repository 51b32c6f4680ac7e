// Sleeping in a callback, which SUNSET's nodes do where work is costly: it holds up everything else
// in the process, heartbeats and services included, as it does there.
#pragma once

#include "base/units.h"

namespace culprit::sunset {

// Returns early, within 10 ms, when a signal to end the process is pending (Executor::stop_on).
void nap(Duration duration);

}  // namespace culprit::sunset
