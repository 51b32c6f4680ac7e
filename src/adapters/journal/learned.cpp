#include "journal/learned.h"

#include <algorithm>

namespace culprit::journal {

Belief grown_from(const Belief& prior, const LearnedBelief& learned) {
  return regrown(learned.belief, learned.prior, prior);
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
