// The components that a failure is about.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// The components that a failure of the rule is about, ascending:
//   - those that it repairs (Rule::repaired);
//   - if it mends some of those that publish what it reads, only these: the others are adapted beside them;
//   - without those that it shows itself to be well (blameless.h).
// A rule that repairs nothing is about the components that its last resorts adapt; one that only reports, about those that
// publish what it reads.
std::vector<ComponentId> touched_by(RuleId rule, const Knowledge& knowledge);

// Does the strategy begin a component anew, or call one of its routines (which may cycle the power of a
// device)? If not, it only reconfigures.
bool mends(const Strategy& strategy);
// Does one of the rule's strategies, but for last resorts?
bool is_mended(RuleId rule, const RuleSet& rules);
// The components that these strategies mend, ascending.
std::vector<ComponentId> mended_by(RuleId rule, const RuleSet& rules);
// The publishers of what the rule reads, if it mends only others (a container, a hub): it shows the effects of what is upstream
// of these, too. A rule that only reconfigures another component is about that one: the robot drives more slowly.
std::vector<ComponentId> watched_beside(RuleId rule, const Knowledge& knowledge);
// Both: the causes of the failure are upstream of these.
std::vector<ComponentId> downstream_of_causes(RuleId rule, const Knowledge& knowledge);
// From where the failure may spread to failures of values: these, and of a bad value that is mended only
// elsewhere (a lamp is switched on where a camera sees too little) also the component whose value it is. A
// rule that only reconfigures another component may be about a good value: the robot drives on.
std::vector<ComponentId> spreads_from(RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::diagnose
