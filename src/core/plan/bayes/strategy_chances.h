// The chances that a failure's strategies resolve it, given those that did not help.
//
// The model: each strategy has one fault of its own; the fault of the failure is one of these, or
// none. Strategy s always helps against its own fault, and by luck against the others:
//
//     v_s = w_s / max(1, S)                  how likely the fault is that of s;  S = sum_t w_t
//     q_s = (w_s - v_s) / (1 - v_s)          its luck with the rest: so that it helps with w_s
//     u_s = v_s' + (1 - v_s') q_s            v_s' = v_s / (1 - sum_{t out} v_t)
//
//   w_s   P_s * e_s
//   P_s   the belief that s helps (knowledge/beliefs.h)
//   out   the strategies of the rule that were tried in this round, or are invalid now: their own
//         fault is ruled out, unless their component is only unreachable
//   e_s   kUnlikely if a process is gone or stopped that another strategy would replace and s would not; or else, if
//         a component that the rule repairs is in trouble (diagnose/trouble.h), and s does not mend it. 1 otherwise
//
// Where the beliefs of a rule sum to one there is no luck: the chances are the beliefs in the
// remaining strategies, renormalised. Where they sum to less, the fault may be one that no strategy
// of the rule fixes, which becomes likelier with each strategy that fails. Where they sum to more,
// some strategies fix the same fault, so one is less promising after the other has failed.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnose/trouble.h"
#include "plan/validity.h"

namespace culprit::plan {

// For a strategy that leaves a component in trouble as it is.
inline constexpr double kUnlikely = 0.05;

struct StrategyChance {
  StrategyId strategy;
  bool is_tried = false;
  std::optional<Invalid> invalid;
  double chance = 0;         // u_s; 0 if it is out
  double luck = 0;           // q_s
  bool is_withheld = false;  // by the governor; it would help as well as ever
  bool leaves_ill = false;   // e_s is kUnlikely

  bool is_out() const { return is_tried || invalid.has_value(); }
  bool is_unheard() const { return !is_tried && invalid && invalid->waits; }
};

using Troubles = std::span<const std::optional<diagnose::TroubleSeen>>;  // by component

// The chances of all strategies of the rule, in their order.
std::vector<StrategyChance> strategy_chances(RuleId rule, Troubles troubles,
                                             const Knowledge& knowledge);

}  // namespace culprit::plan
