// Does a strategy make sense in the present state of the system? (paper, Algorithm 1, condition 2)
//
// An adaptation is valid if it would change something and can be carried out:
//   - set, increase, decrease parameter, change mode, call: its component is alive, and nothing
//     else sets back what it sets;
//   - change communication: likewise, and the parameter does not name the topic already;
//   - activate: its component is alive, has a lifecycle, and is not active;
//   - deactivate: its component is alive and active;
//   - restart: it is alive and has a lifecycle, for a dead or hung process answers no request;
//   - redeploy: it has a LAUNCH command; and it is not the sender of topics that the rule misses, inactive by
//     the doing of others: it comes back inactive;
//   - start: it has a LAUNCH command and is not there;
//   - stop: it is there.
// In steps, one that is so already is passed over: a dead component is deactivated. So is the activation of what
// an earlier step had not to deactivate. Not all may be.
// A component on a computer that is unreachable, or cannot be asked, cannot be adapted. A redeploy or a start
// waits while a thing that the start needs is missing (StartBarred). For an exhausted rule only what goes on is
// valid (Knowledge::goes_on). A strategy is valid if each of its adaptations is, given the ones
// before it, and its WHEN condition is true. Further, no last resort may hold what it would change,
// or end with it (knowledge/held.h, also_ended.h). It must not have brought back a more critical failure (analyze/parameter_fights.h), and its
// component must not be out of work with its group: paused, or being brought up or down. A last
// resort is never valid for a planner: the manager begins it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knowledge/event.h"
#include "knowledge/knowledge.h"

namespace culprit::plan {

struct Invalid {
  ComponentId component;  // what it is about; for a WHEN condition the strategy's first
  std::string reason;
  // Its state is unknown (Knowledge::is_unheard), it cannot be asked now, or it is as its group is: the
  // strategy waits, and uses up no attempt. So it does for the failure of a last resort that holds it.
  bool waits = false;
};

// Empty if the strategy is valid.
std::optional<Invalid> invalidity(const Strategy& strategy, const Knowledge& knowledge);

// Whether the strategy cannot be chosen whatever else is: it was tried, it is invalid, or it is withheld.
// The candidate then says so.
bool is_excluded_alone(Candidate& candidate, const Knowledge& knowledge);

// A last resort has only these obstacles: a part cannot be carried out, one that is as critical holds what the
// part would change, or its WHEN is not true.
struct LastResortParts {
  // By place in Strategy::adaptations. Empty: the part can be carried out, or holds already.
  std::vector<std::string> obstacles;
  // Why none can be begun. Empty: one can, or, if it has steps, each.
  std::string obstacle;
};
LastResortParts parts_of_last_resort(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::plan
