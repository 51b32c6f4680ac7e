#include "knowledge/beliefs.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit {

namespace {

// 0 would stay 0 for ever.
double pseudo_count(double count) { return count > 0 ? count : 0.5; }

constexpr double kLeast = 0.05;

double faded(double count, double forgetting) {
  return std::max(std::min(kLeast, count), forgetting * count);
}

}  // namespace

Belief initial_belief(Probability success, double confidence) {
  return {pseudo_count(confidence * success.value), pseudo_count(confidence * (1 - success.value))};
}

Belief regrown(const Belief& belief, const Belief& from, const Belief& onto) {
  if (from == onto) return belief;
  const auto grown = [](double count, double old, double start) {
    return std::max(std::min(kLeast, start), start + count - old);
  };
  return {grown(belief.alpha, from.alpha, onto.alpha), grown(belief.beta, from.beta, onto.beta)};
}

Beliefs::Beliefs(const RuleSet& rules) {
  for (const Strategy& strategy : rules.strategies)
    priors_.push_back(initial_belief(strategy.success, strategy.confidence));
  beliefs_ = priors_;
}

void Beliefs::set(StrategyId id, Belief belief, Belief prior) {
  beliefs_[id.index] = belief;
  priors_[id.index] = prior;
}

bool Beliefs::begin_from(StrategyId id, Belief prior) {
  Belief& belief = beliefs_[id.index];
  Belief& old = priors_[id.index];
  const bool is_fixed = forgetting_ < 1 && belief != old;
  if (prior == old || is_fixed) return false;
  belief = regrown(belief, old, prior);
  old = prior;
  return true;
}

void Beliefs::learn(StrategyId id, Belief outcome) {
  Belief& belief = beliefs_[id.index];
  CULPRIT_ASSERT(outcome.alpha >= 0 && outcome.beta >= 0 && outcome.alpha + outcome.beta <= 1);
  belief.alpha = faded(belief.alpha, forgetting_) + outcome.alpha;
  belief.beta = faded(belief.beta, forgetting_) + outcome.beta;
}

}  // namespace culprit
