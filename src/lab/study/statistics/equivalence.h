// Do two samples have the same mean, to within a margin? Two one-sided tests (TOST; Schuirmann: "A
// comparison of the two one-sided tests procedure and the power approach", 1987), each Welch's.
//
//     t_low  = (d + margin) / e        t_high = (d - margin) / e        d = mean_b - mean_a
//
// with e and the degrees of freedom as in welch.h. Equivalent at 5 % if both one-sided p are below
// 0.05, which is the same as: the 90 % interval of d lies within ± margin. A missing difference
// proves nothing; this test does.
#pragma once

#include <optional>

#include "study/statistics/moments.h"

namespace culprit::study {

struct EquivalenceTest {
  double difference = 0;  // mean of the second minus mean of the first
  double margin = 0;      // > 0, in the samples' unit
  double low = 0;         // of the difference's 90 % interval
  double high = 0;
  double p = 1;  // the larger of the two

  bool is_equivalent() const { return p < 0.05; }
};

// Empty if a sample has fewer than two values, or if neither has any spread. @pre margin > 0
std::optional<EquivalenceTest> equivalence_test(const Moments& first, const Moments& second,
                                                double margin);

}  // namespace culprit::study
