// How likely each strategy is to help (paper, "Success Rate Adaptation").
//
//     p_s ~ Beta(alpha, beta),  alpha_0 = c_p P_s,init,  beta_0 = c_p (1 - P_s,init)
//     helped: alpha + 1         did not: beta + 1        P_s = E(p_s) = alpha / (alpha + beta)
//
// With forgetting (gamma < 1), which follows a rate that drifts, both pseudo-counts are first
// multiplied by gamma: what happened n outcomes ago weighs gamma^n.
//
// A pseudo-count that would start at 0 starts at 0.5 instead, so that a designer's 100 % can still
// be unlearned (the paper notes that its own update never converges there). All others are what the
// designer said. None is forgotten to less than 0.05, or than what it started with.
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
  void helped(StrategyId id) { learn(id, {1, 0}); }
  void did_not_help(StrategyId id) { learn(id, {0, 1}); }
  void set_forgetting(double forgetting) { forgetting_ = forgetting; }
  void set(StrategyId id, Belief belief) { beliefs_[id.index] = belief; }

 private:
  void learn(StrategyId id, Belief outcome);

  std::vector<Belief> beliefs_;
  double forgetting_ = 1;
};

}  // namespace culprit
