// Does a failure wait for the repair of a component that all of its strategies need?
//
// A strategy that refocuses a camera has no effect while the camera is down. Such a round is no
// failed attempt: otherwise the failure would be exhausted by the time the camera is back, and no
// strategy would refocus it. So it waits as long as another failure may bring the component back,
// or waits for a person together with that failure. If no strategy repairs the component, the round
// counts, since otherwise no person would be told.
#pragma once

#include "plan/planner.h"

namespace culprit::plan {

// `decision` is of a failure for which nothing was chosen.
bool awaits_repair(const Decision& decision, const Knowledge& knowledge);

}  // namespace culprit::plan
