// A strategy of a failure that is to be decided about, as the bayes planner weighs it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "knowledge/event.h"
#include "plan/bayes/exclusions.h"

namespace culprit::plan {

struct WeighedCandidate {
  Candidate candidate;
  std::size_t failure = 0;    // its node (diagnose::Causes)
  Criticality level{};        // of the failure
  std::int64_t worth = 0;     // plan/ties.h
  std::int64_t cost = 0;      // the same
  std::size_t place = 0;      // among the possible tries of the failure
  bool only_revives = false;  // waits for no other failure
  bool goes_round = false;    // is done beside the repair of its cause
  Exclusions::Places affected;
};

inline void exclude(WeighedCandidate& weighed, const Exclusions::Obstacle& obstacle) {
  weighed.candidate.excluded = obstacle.condition;
  weighed.candidate.component = obstacle.component;
  weighed.candidate.failure = obstacle.because;
}

}  // namespace culprit::plan
