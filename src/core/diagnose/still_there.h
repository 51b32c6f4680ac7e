// The probability that a failure's cause remains after some strategies were tried in vain
// (plan/bayes/strategy_chances.h defines v and q).
#pragma once

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// q: the luck of a strategy that helps with `chance` and is for the share `own` of what may be wrong.
inline double luck_of(double chance, double own) {
  return own < 1 ? (chance - own) / (1 - own) : 0;
}

// The probability that the fault would still be there after all attempts at the rule's component:
//
//     (1 - sum_{t tried} v_t) prod_{t tried} (1 - q_t) (prod_t (1 - P_t))^rounds
//
// A strategy that is tried again in a later round may be lucky as at first.
double still_there(RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::diagnose
