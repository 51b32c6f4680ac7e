#include "knowledge/beliefs.h"

#include <algorithm>

namespace culprit {

namespace {

// 0 would stay 0 for ever.
double pseudo_count(double count) { return count > 0 ? count : 0.5; }

double faded(double count, double forgetting) {
  constexpr double kLeast = 0.05;
  return std::max(std::min(kLeast, count), forgetting * count);
}

}  // namespace

Belief initial_belief(Probability success, double confidence) {
  return {pseudo_count(confidence * success.value), pseudo_count(confidence * (1 - success.value))};
}

Beliefs::Beliefs(const RuleSet& rules) {
  for (const Strategy& strategy : rules.strategies) {
    beliefs_.push_back(initial_belief(strategy.success, strategy.confidence));
  }
}

void Beliefs::learn(StrategyId id, Belief outcome) {
  Belief& belief = beliefs_[id.index];
  belief.alpha = faded(belief.alpha, forgetting_) + outcome.alpha;
  belief.beta = faded(belief.beta, forgetting_) + outcome.beta;
}

}  // namespace culprit
