#include "study/statistics/equivalence.h"

#include <algorithm>

#include <boost/math/distributions/students_t.hpp>

#include "base/invariant.h"
#include "study/statistics/welch.h"

namespace culprit::study {

std::optional<EquivalenceTest> equivalence_test(const Moments& first, const Moments& second,
                                                double margin) {
  CULPRIT_ASSERT(margin > 0);
  const auto welch = welch_test(first, second);
  if (!welch) return std::nullopt;
  EquivalenceTest test;
  test.difference = welch->difference;
  test.margin = margin;
  const boost::math::students_t distribution(welch->degrees);
  using boost::math::complement;
  const double reach_95 = quantile(complement(distribution, 0.025));
  const double error = (welch->high - welch->low) / 2 / reach_95;
  const double reach = quantile(complement(distribution, 0.05)) * error;
  test.low = test.difference - reach;
  test.high = test.difference + reach;
  const double p_low = cdf(complement(distribution, (test.difference + margin) / error));
  const double p_high = cdf(distribution, (test.difference - margin) / error);
  test.p = std::max(p_low, p_high);
  return test;
}

}  // namespace culprit::study
