// Do two samples have the same mean, if their spreads may differ (Welch's t)?
//
//     t = (mean_b - mean_a) / sqrt(s_a^2 / n_a + s_b^2 / n_b)
//
// with the degrees of freedom of Welch and Satterthwaite. Only moments are needed, so a published
// summary (Moments::of_summary) is as good as a sample. Checked against R's t.test.
#pragma once

#include <optional>

#include "study/statistics/moments.h"

namespace culprit::study {

struct WelchTest {
  double t = 0;
  double degrees = 0;
  double p = 1;           // two-sided
  double difference = 0;  // mean of the second minus mean of the first
  double low = 0;         // of its 95 % confidence interval
  double high = 0;
};

// Empty if a sample has fewer than two values, or if neither has any spread.
std::optional<WelchTest> welch_test(const Moments& first, const Moments& second);

}  // namespace culprit::study
