// How likely each strategy is to help (paper, "Success Rate Adaptation").
//
//     p_s ~ Beta(alpha, beta),  alpha_0 = c_p P_s,init,  beta_0 = c_p (1 - P_s,init)
//     helped: alpha + 1         did not: beta + 1        P_s = E(p_s) = alpha / (alpha + beta)
//
// With forgetting (gamma < 1), which follows a rate that drifts, both pseudo-counts are first
// multiplied by gamma: what happened n outcomes ago weighs gamma^n.
//
// Where a fleet shares what it learned, its prior takes the place of the designer's
// (pooled_prior.h).
//
// A pseudo-count that would start at 0 starts at 0.5 instead, so that a designer's 100 % can still
// be unlearned. (The paper notes that its own update never converges there.) All others start at
// the designer's numbers. Forgetting never takes one below 0.05, or below its start if that is less.
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

// `belief` as if it had grown from another prior: the counted outcomes stay. Neither count falls
// below the floor of forgetting.
Belief regrown(const Belief& belief, const Belief& from, const Belief& onto);

class Beliefs {
 public:
  explicit Beliefs(const RuleSet& rules);

  const Belief& operator[](StrategyId id) const { return beliefs_[id.index]; }
  void helped(StrategyId id) { learn(id, {1, 0}); }
  void did_not_help(StrategyId id) { learn(id, {0, 1}); }
  void set_forgetting(double forgetting) { forgetting_ = forgetting; }
  void set(StrategyId id, Belief belief) { beliefs_[id.index] = belief; }

  // The belief in `id` before any outcome: the designer's, unless another prior was set.
  const Belief& prior(StrategyId id) const { return priors_[id.index]; }
  // For a belief from an earlier run.
  void set(StrategyId id, Belief belief, Belief prior);
  // Begins from another prior; the counted outcomes stay. With forgetting, a change by outcomes
  // stays as it is, because the share of the old prior that is left in it is unknown. Gives whether
  // anything changed.
  bool begin_from(StrategyId id, Belief prior);
  // Back to the prior.
  void forget(StrategyId id) { beliefs_[id.index] = priors_[id.index]; }

 private:
  void learn(StrategyId id, Belief outcome);

  std::vector<Belief> beliefs_;
  std::vector<Belief> priors_;
  double forgetting_ = 1;
};

}  // namespace culprit
