// Does a failure wait until one of its strategies makes sense?
//
// Such a round is no failed attempt: otherwise the failure would be exhausted before anything was
// tried, and nothing would be tried later. There are two cases in which none makes sense now, and
// one may later:
//   - All need a component that is down, as one that refocuses a camera. It waits as long as another
//     failure may bring the component back, or waits for a person together with that failure. If no
//     strategy repairs the component, the round counts, since otherwise no person would be told.
//   - The WHEN of one is not true, as of one that may open a gripper only while it holds nothing.
// A strategy that ends such a wait does not itself wait for that failure, even as an effect of it.
#pragma once

#include "plan/planner.h"
#include "plan/validity.h"

namespace culprit::plan {

// `decision` is of a failure for which nothing was chosen.
bool awaits_valid_strategy(const Decision& decision, const Knowledge& knowledge);

// Would `strategy` make `waiting` possible, which is invalid now (`why`)? It brings back the component that is
// down, brings up the group with which the component is out of work, or makes the WHEN true.
bool makes_possible(const Strategy& strategy, const Strategy& waiting, const Invalid& why,
                    const Knowledge& knowledge);

}  // namespace culprit::plan
