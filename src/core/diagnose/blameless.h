// Whether a failure shows by itself that a component is well: of a rule that watches several, "any of these is silent".
//
//     TRIGGER !alive(left) || !alive(right)
//
// The failure's outages are those of its inputs that tell of no data or no answer: ages, rates, suspicions, what is alive. A component is
// blameless if the rule reads outages of it, and
//   1. the trigger would be true if none of them were bad, so nothing that is done to the component can end the failure; and
//   2. the trigger would not be true if none of those of the rule's other components were bad, so one of them is the reason.
// A value that some component measures may be bad because of any other, so values never make a component blameless. If the
// known death of a component made the trigger true, its topics count as silent already, as they will be.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

bool is_blameless(ComponentId component, RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::diagnose
