#include "journal/learned.h"

#include <algorithm>

namespace culprit::journal {

Belief grown_from(const Belief& prior, const LearnedBelief& learned) {
  if (prior == learned.prior) return learned.belief;
  // Forgetting may have gone below the old prior: none comes to less than in Beliefs.
  const auto grown = [](double from, double count, double old) {
    constexpr double kLeast = 0.05;
    return std::max(std::min(kLeast, from), from + count - old);
  };
  return {grown(prior.alpha, learned.belief.alpha, learned.prior.alpha),
          grown(prior.beta, learned.belief.beta, learned.prior.beta)};
}

void merge(Learned& learned, const Learned& other) {
  for (const LearnedBelief& theirs : other.beliefs) {
    const auto ours = std::find_if(
        learned.beliefs.begin(), learned.beliefs.end(), [&](const LearnedBelief& belief) {
          return belief.rule == theirs.rule && belief.strategy == theirs.strategy;
        });
    if (ours == learned.beliefs.end()) {
      learned.beliefs.push_back(theirs);
    } else {
      ours->belief = grown_from(ours->belief, theirs);
    }
  }
  for (const LearnedCoupling& theirs : other.couplings) {
    const auto ours = std::find_if(
        learned.couplings.begin(), learned.couplings.end(), [&](const LearnedCoupling& coupling) {
          return coupling.cause == theirs.cause && coupling.effect == theirs.effect;
        });
    if (ours == learned.couplings.end()) {
      learned.couplings.push_back(theirs);
    } else {
      ours->coupling.cleared += theirs.coupling.cleared;
      ours->coupling.stayed += theirs.coupling.stayed;
    }
  }
}

}  // namespace culprit::journal
