// How likely each strategy is to help (paper, "Success Rate Adaptation").
//
//     p_s ~ Beta(alpha, beta),  alpha_0 = c_p P_s,init,  beta_0 = c_p (1 - P_s,init)
//     helped: alpha + 1         did not: beta + 1        P_s = E(p_s) = alpha / (alpha + beta)
//
// Neither pseudo-count starts below 0.5, so that a designer's 100 % can still be unlearned (the
// paper notes that its own update never converges there).
#pragma once

#include <vector>

#include "language/rule_set.h"

namespace culprit {

struct Belief {
  double alpha = 1;
  double beta = 1;

  Probability mean() const { return {alpha / (alpha + beta)}; }
  bool operator==(const Belief&) const = default;
};

// The designer's belief: success probability and confidence c_p > 0.
Belief initial_belief(Probability success, double confidence);

class Beliefs {
 public:
  explicit Beliefs(const RuleSet& rules);

  const Belief& operator[](StrategyId id) const { return beliefs_[id.index]; }
  void helped(StrategyId id) { beliefs_[id.index].alpha += 1; }
  void did_not_help(StrategyId id) { beliefs_[id.index].beta += 1; }
  void set(StrategyId id, Belief belief) { beliefs_[id.index] = belief; }

 private:
  std::vector<Belief> beliefs_;
};

}  // namespace culprit
