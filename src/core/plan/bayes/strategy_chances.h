// What would fix it? The chances of a failure's strategies, given those that did not help.
//
// What is wrong is one of as many things as the rule has strategies, or none of them. Strategy s
// always helps against its own, and by luck against the others:
//
//     v_s = w_s / max(1, S)                  how likely it is what s is for;  S = sum_t w_t
//     q_s = (w_s - v_s) / (1 - v_s)          its luck with the rest: so that it helps with w_s
//     u_s = v_s' + (1 - v_s') q_s            v_s' = v_s / (1 - sum_{t out} v_t)
//
//   w_s   P_s * e_s
//   P_s   the belief that s helps (knowledge/beliefs.h)
//   out   the strategies of the rule that were tried in this round, or are invalid now: what they
//         are for, it is not
//   e_s   evidence of the operating system: kUnlikely if the process of a component is gone or
//         stopped that another strategy would replace, and s would not; 1 otherwise
//
// Where the beliefs of a rule sum to one there is no luck: these are the beliefs in what is left,
// renormalised. Where they sum to less, something is wrong that no strategy of the rule fixes, and
// that grows likelier with each that failed; where to more, one fixes what another would fix as
// well, and less is left for the one when the other failed.
#pragma once

#include <optional>
#include <vector>

#include "plan/validity.h"

namespace culprit::plan {

// Of a strategy that leaves a dead process as it is.
inline constexpr double kUnlikely = 0.05;

struct StrategyChance {
  StrategyId strategy;
  bool is_tried = false;
  std::optional<Invalid> invalid;
  double chance = 0;         // u_s; 0 if it is out
  double luck = 0;           // q_s
  bool is_withheld = false;  // by the governor; it would help as well as ever

  bool is_out() const { return is_tried || invalid.has_value(); }
};

// Of all strategies of the rule, in their order.
std::vector<StrategyChance> strategy_chances(RuleId rule, const Knowledge& knowledge);

// The probability that what is wrong would still be there after all that was tried at the rule's
// component:
//
//     (1 - sum_{t tried} v_t) prod_{t tried} (1 - q_t) (prod_t (1 - P_t))^rounds
//
// Who comes round again may be lucky with each as at first.
double still_there(RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::plan
