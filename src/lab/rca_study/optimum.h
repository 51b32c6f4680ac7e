// The optimum of a small robot: exact dynamic programming over what can be known of it.
//
//     V(x) = 0                                                 if nobody is ill in situation x
//     V(x) = cost of leaving it ill                            if nothing is left to try
//     V(x) = min_A ( cost(A) + sum_o P(o | x, A) V(x_{A,o}) )  otherwise
//
// or the cost of leaving it ill, if going on costs more,
// with the situations x, rounds A and outcomes o of repair_process.h. Each round tries something
// that may be tried a few times only, so the recursion ends; each situation is worked out once. The
// optimum knows the success rates against every kind of fault and how often each subscription
// passes failures on. No planner of rules knows these. It does not know which components broke. So
// no planner that keeps the promises of culprit's planners can do better.
//
// The cost of a planner, V_planner, is the same sum with the round that it begins in x instead of
// the best one: what it decides is asked of the planner itself, shown what a manager would know.
// Both are expectations over all that can happen, not means of samples. The regret is
//
//     V_planner / V - 1        with both summed over the first situations, and over the robots
//
// Two omissions do not change it. Subscriptions that no observation will ever distinguish are
// merged (repair_process.h). A round is not followed further if it costs more than another one even
// with full knowledge of the faults. If the observations reveal the faults anyway, that is the
// cost.
//
// Source: Kaelbling, Littman, Cassandra, "Planning and acting in partially observable stochastic
// domains", Artificial Intelligence 101, 1998, section 3: the optimal policy is one of the belief.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "plan/planner.h"
#include "rca_study/repair_process.h"

namespace culprit::study::rca {

class Optimum {
 public:
  // `process` must outlive it.
  explicit Optimum(const RepairProcess& process) : process_(process) {}

  // The expected cost until all is well, from the beginning, and from a situation on.
  double cost();
  double cost(const Situation& situation) { return best(situation).cost; }
  // The round to begin; empty if no strategy is left or worth it, or no component is ill.
  const Round& round(const Situation& situation) { return best(situation).round; }

 private:
  struct Best {
    double cost = 0;
    Round round;
  };
  const Best& best(const Situation& situation);
  // A round that may begin.
  struct Begun {
    double least = 0;       // it costs no less
    std::size_t place = 0;  // among all of the situation
    Round round;
    std::vector<RepairProcess::Outcome> outcomes;
  };
  double cost_below(const Begun& begun, double limit);
  double least(const Situation& situation);

  const RepairProcess& process_;
  std::unordered_map<std::string, Best> known_;
};

// The expected cost of `planner` from the beginning. `rules` are those of the process.
double expected_cost(const RepairProcess& process, const RuleSet& rules, const Planner& planner);

// Plays the optimum on culprit's manager, in rounds: nothing is begun while a strategy is under
// way, or shortly after a failure came or went. It knows no more of the past than the current
// observations and earlier tries, so its belief may be less sharp than the one above. @pre
// RepairProcess::is_small(scenario)
std::unique_ptr<const Planner> optimum_planner(const RcaScenario& scenario, Objective objective);

}  // namespace culprit::study::rca
