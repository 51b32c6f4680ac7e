// What would fix it? The chances of a failure's strategies, given those that did not help.
//
//     u_s = min(1, w_s / max(w_s, 1 - sum_{t out} w_t)),    w_s = P_s * e_s
//
//   P_s   the belief that s helps (knowledge/beliefs.h)
//   out   the strategies of the rule that were tried in this round, or are invalid now: what they
//         would have fixed, it is not
//   e_s   evidence of the operating system: kUnlikely if the process of a component is gone or
//         stopped that another strategy would replace, and s would not; 1 otherwise
//
// Where the beliefs of a rule sum to one, these are the beliefs in what is left, renormalised.
// Where they sum to less, something is wrong that no strategy of the rule fixes, and that grows
// likelier with each that failed; where to more, one fixes what another would fix as well.
#pragma once

#include <optional>
#include <vector>

#include "plan/validity.h"

namespace culprit::plan {

// Of a strategy that leaves a dead process as it is.
inline constexpr double kUnlikely = 0.05;

struct Remedy {
  StrategyId strategy;
  bool is_tried = false;
  std::optional<Invalid> invalid;
  double chance = 0;         // u_s; 0 if it is out
  bool is_withheld = false;  // by the governor; it would help as well as ever

  bool is_out() const { return is_tried || invalid.has_value(); }
};

// Of all strategies of the rule, in their order.
std::vector<Remedy> remedies(RuleId rule, const Knowledge& knowledge);

}  // namespace culprit::plan
