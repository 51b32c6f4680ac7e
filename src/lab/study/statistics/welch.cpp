#include "study/statistics/welch.h"

#include <cmath>

#include <boost/math/distributions/students_t.hpp>

namespace culprit::study {

std::optional<WelchTest> welch_test(const Moments& first, const Moments& second) {
  if (first.count() < 2 || second.count() < 2) return std::nullopt;
  const auto first_count = static_cast<double>(first.count());
  const auto second_count = static_cast<double>(second.count());
  // Squared standard errors of the two means.
  const double a = first.sample_variance() / first_count;
  const double b = second.sample_variance() / second_count;
  if (a + b == 0) return std::nullopt;

  WelchTest test;
  test.difference = second.mean() - first.mean();
  const double error = std::sqrt(a + b);
  test.t = test.difference / error;
  test.degrees = (a + b) * (a + b) / (a * a / (first_count - 1) + b * b / (second_count - 1));
  const boost::math::students_t distribution(test.degrees);
  using boost::math::complement;
  test.p = 2 * cdf(complement(distribution, std::abs(test.t)));
  const double reach = quantile(complement(distribution, 0.025)) * error;
  test.low = test.difference - reach;
  test.high = test.difference + reach;
  return test;
}

}  // namespace culprit::study
