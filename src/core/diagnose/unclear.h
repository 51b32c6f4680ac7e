// Until when the cause of what a failure shows now may have begun, if that is later than its onset.
//
// A failure that is still there after what caused it is over has another cause, which may have begun until it would have shown
// that all is well: after a new process of its component, or one that became active; after a failure upstream has cleared, or
// a trouble there; and after a strategy that did not help.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// When the failure would have shown that all is well, after its cause was over `since` then.
Time shows_by(RuleId failure, Time since, const Knowledge& knowledge);

// kLongAgo: its onset counts alone. Without troubles upstream that are over.
// @pre the onset of the failure is known (RuleState::onset)
Time unclear_until(RuleId failure, const Knowledge& knowledge);

}  // namespace culprit::diagnose
