// Does a strategy make sense in the present state of the system? (paper, Algorithm 1, condition 2)
//
// An adaptation is valid if it would change something and can be carried out:
//   - set, increase, decrease parameter, change mode, call: its component is alive, and nothing
//     else sets back what it sets;
//   - change communication: likewise, and the parameter does not name the topic already;
//   - activate: its component is alive, has a lifecycle, and is not active;
//   - deactivate: its component is alive and active;
//   - restart: it is alive and has a lifecycle, for a dead or hung process answers no request;
//   - redeploy: it has a LAUNCH command;
//   - start: it has a LAUNCH command and is not there;
//   - stop: it is there.
// In steps, one that is so already is passed over: a dead component is deactivated. So is the activation of what
// an earlier step had not to deactivate. Not all may be.
// A component on a computer that is unreachable, or cannot be asked, cannot be adapted. A redeploy or a start
// waits while a thing that the start needs is missing (StartBarred). For an exhausted rule only what goes on is
// valid (Knowledge::goes_on). A strategy is valid if each of its adaptations is, given the ones
// before it, and its WHEN condition is true. Further, no last resort whose failure is still there may have set the
// same thing, it must not have brought back a more critical failure (analyze/parameter_fights.h), and its component
// must not be out of work with its group: paused, or being brought up or down. A last
// resort is never valid for a planner: the manager begins it.
#pragma once

#include <optional>
#include <string>

#include "knowledge/knowledge.h"

namespace culprit::plan {

struct Invalid {
  ComponentId component;  // what it is about; for a WHEN condition the strategy's first
  std::string reason;
  // Its state is unknown (Knowledge::is_unheard), it cannot be asked now, or it is as its group is: the
  // strategy waits, and uses up no attempt.
  bool waits = false;
};

// Empty if the strategy is valid.
std::optional<Invalid> invalidity(const Strategy& strategy, const Knowledge& knowledge);

// The same for a last resort, which has only two obstacles: it cannot be carried out, or its WHEN
// is not true.
std::optional<Invalid> impossibility(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
