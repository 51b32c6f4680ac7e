#include "knowledge/beliefs.h"

#include <algorithm>

namespace culprit {

Belief initial_belief(Probability success, double confidence) {
  constexpr double kLeast = 0.5;
  return {std::max(kLeast, confidence * success.value),
          std::max(kLeast, confidence * (1 - success.value))};
}

Beliefs::Beliefs(const RuleSet& rules) {
  for (const Strategy& strategy : rules.strategies) {
    beliefs_.push_back(initial_belief(strategy.success, strategy.confidence));
  }
}

void Beliefs::learn(StrategyId id, Belief outcome) {
  constexpr double kLeast = 0.05;
  Belief& belief = beliefs_[id.index];
  belief.alpha = std::max(kLeast, forgetting_ * belief.alpha) + outcome.alpha;
  belief.beta = std::max(kLeast, forgetting_ * belief.beta) + outcome.beta;
}

}  // namespace culprit
