// What is a strategy worth, and what does it cost? (docs/planning.md)
//
// Cost of trying s once, in vain or not, with the weights of the objective:
//
//     c_s = a_time (i_exec,s + l) / i_max + a_attempt + a_redeployment r_s + a_disruption d_s
//
//   i_exec,s, i_max   the impact of s and the highest of the rule set, in cycles (paper, Eq. 1)
//   l                 how long the signals of the failure take to show a change, in cycles
//   r_s               processes that s replaces
//   d_s               share of all components that s takes down, those that depend on them included
//
// Expected cost of repairing the failure beginning with s, and going on with the others in the
// order of u/c (p/c index), as long as they fail:
//
//     E_s = c_s + sum_k c_k a(s and all before k),    a(T) = (1 - sum_{t in T} v_t) prod (1 - q_t)
//
//   v, q   of the strategies (plan/bayes/strategy_chances.h): the probability that one is what would
//          fix it, and its luck otherwise
//   a(T)   the probability that the failure is still there after all of T
//
// Without luck that order is the cheapest for one failure (Smith's rule; exchange two neighbours
// and compare), so the strategy with the highest u/c has the lowest E.
//
// Value of beginning to repair failure i:
//
//     V_i = R_i Q_i (W_i + sum_k share(i -> k) W_k),    Q_i = min(1, sum_s u_s)
//
//   R_i           its responsibility (diagnose/diagnosis.h)
//   W             1, 2 or 4: how much worse each level of criticality is than the one below it
//   share(i -> k) the part of failure k that is put down to i, or how often k was seen to clear
//                 with it; in one feedback loop kappa(i -> k), as if i had been the first
#pragma once

#include <span>
#include <vector>

#include "knowledge/knowledge.h"
#include "plan/bayes/objective.h"

namespace culprit::plan {

// W
double weight(Criticality level);

// The effort of one try of a strategy.
struct Effort {
  Cycles impact;
  Duration latency{};  // of the failure's signals
  int redeployments = 0;
  double disruption = 0;  // 0..1
};
// c_s, and its first part, what the time costs
double try_cost(const Effort& effort, const CostWeights& weights, const RuleSet& rules);
double time_cost(const Effort& effort, const CostWeights& weights, const RuleSet& rules);

struct Try {
  double chance = 0;  // u
  double cost = 0;    // c > 0
  double time = 0;    // the part of it that its time costs
  double luck = 0;    // q <= u
};

// a: the probability that a failure is still there after some tries.
class StillThere {
 public:
  double chance() const { return left_ * unlucky_; }
  void fails(const Try& tried);

 private:
  double left_ = 1;
  double unlucky_ = 1;
};

// u/c
inline double index(const Try& tried) { return tried.chance / tried.cost; }
// E_s for each of `tries`, which are in the order of their indices, highest first.
std::vector<double> expected_costs(std::span<const Try> tries);

}  // namespace culprit::plan
