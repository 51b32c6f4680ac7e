// Does a failure wait until a component is repaired that all of its strategies need?
//
// Whoever can only refocus a camera can do nothing while the camera is dead. That is no attempt
// that failed: were it counted, the failure would be exhausted when the camera is back, and nobody
// would refocus it. So it waits as long as another failure may bring the component back, or waits
// for a person with it. Where nobody is at work on the component, the round counts: else nobody
// would be told. A failure with a LASTRESORT does not wait: the safe stop must come.
#pragma once

#include "plan/planner.h"

namespace culprit::plan {

// `decision` is of a failure for which nothing was chosen.
bool awaits_repair(const Decision& decision, const Knowledge& knowledge);

}  // namespace culprit::plan
