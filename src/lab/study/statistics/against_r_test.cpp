// The statistics against R 4.2.2. A comment above each test names the source of the expected
// values.
#include <cmath>

#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include "study/statistics/anova.h"
#include "study/statistics/equivalence.h"
#include "study/statistics/rank_correlation.h"
#include "study/statistics/studentized_range.h"
#include "study/statistics/welch.h"

namespace culprit::study {
namespace {

//     set.seed(4)
//     a <- round(rnorm(12, 5, 1), 2);     b <- round(rnorm(9, 6, 1.5), 2)
//     c <- round(rnorm(15, 5.2, 0.8), 2); d <- round(rnorm(12, 7, 2), 2)
std::vector<Moments> groups() {
  const std::vector<std::vector<double>> values = {
      {5.22, 4.46, 5.89, 5.6, 6.64, 5.69, 3.72, 4.79, 6.9, 6.78, 5.57, 5.02},
      {6.57, 5.93, 6.05, 6.25, 7.75, 5.93, 5.85, 5.57, 8.31},
      {5.33, 6.25, 6.23, 5.67, 4.97, 6.2, 5.93, 4.46, 6.19, 5.32, 6.04, 4.6, 4.01, 5.89, 4.88},
      {6.55, 8.87, 6.07, 5.72, 9.69, 7.36, 9.59, 3.62, 5.36, 5.28, 7.2, 6.25}};
  std::vector<Moments> groups(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const double value : values[i]) groups[i].add(value);
  return groups;
}

void expect_relative(double actual, double expected, double tolerance) {
  EXPECT_NEAR(actual, expected, std::abs(expected) * tolerance);
}

//     ptukey(q, k, v, lower.tail = FALSE)
// R's own error is about 1e-10, which is why a tail of 7e-11 is compared in its first digits only.
TEST(AgainstR, TailsOfTheStudentizedRange) {
  expect_relative(studentized_range_tail(3.5, 3, 10), 0.0771033108387, 1e-8);
  expect_relative(studentized_range_tail(1, 2, 5), 0.51108408043, 1e-8);
  expect_relative(studentized_range_tail(4.29, 8, 1288), 0.050351107588, 1e-8);
  expect_relative(studentized_range_tail(2, 8, 1288), 0.850869417624, 1e-8);
  expect_relative(studentized_range_tail(0.5, 5, 3), 0.994828504096, 1e-8);
  expect_relative(studentized_range_tail(6, 20, 60), 0.0103350577199, 1e-8);
  EXPECT_NEAR(studentized_range_tail(10, 8, 1288), 7.02295999133e-11, 1e-10);
}

//     qtukey(1 - p, k, v)    R promises four digits.
TEST(AgainstR, QuantilesOfTheStudentizedRange) {
  expect_relative(studentized_range_quantile(0.05, 3, 10), 3.87677674919, 1e-4);
  expect_relative(studentized_range_quantile(0.05, 8, 1288), 4.2933990117, 1e-4);
  expect_relative(studentized_range_quantile(0.01, 5, 20), 5.29325251169, 1e-4);
}

// For two means, the range is |t| sqrt(2). At two degrees of freedom R's ptukey is off in the third
// digit: qtukey(0.95, 2, 2) gives 6.0796, sqrt(2) qt(0.975, 2) is 6.0849. So this is compared with
// t.
TEST(StudentizedRange, OfTwoMeansIsStudentsT) {
  using boost::math::complement;
  for (const double degrees : {1.0, 2.0, 5.0, 1288.0}) {
    const boost::math::students_t t(degrees);
    for (const double q : {0.1, 3.0, 6.0, 10.0}) {
      expect_relative(studentized_range_tail(q, 2, degrees),
                      2 * cdf(complement(t, q / std::sqrt(2.0))), 1e-8);
    }
    expect_relative(studentized_range_quantile(0.05, 2, degrees),
                    std::sqrt(2.0) * quantile(complement(t, 0.025)), 1e-8);
  }
}

//     m <- aov(y ~ g); summary(m)
TEST(AgainstR, OneWayAnova) {
  const auto anova = one_way_anova(groups());
  ASSERT_TRUE(anova);
  EXPECT_EQ(anova->degrees_between, 3);
  EXPECT_EQ(anova->degrees_within, 44);
  EXPECT_NEAR(anova->f, 3.91756, 5e-6);
  expect_relative(anova->mean_square_within, 1.41335595960, 1e-11);
  expect_relative(anova->p, 0.0145500049428, 1e-10);
}

//     TukeyHSD(m)$g
TEST(AgainstR, TukeysHonestlySignificantDifference) {
  struct Expected {
    std::size_t second;
    std::size_t first;
    Difference difference;
  };
  const std::vector<Expected> table = {
      {1, 0, {0.9444444444444, -0.4552580259882, 2.344146914877, 0.2863019901334}},
      {2, 0, {-0.0586666666667, -1.2880394353680, 1.170706102035, 0.9992493527733}},
      {3, 0, {1.2733333333333, -0.0225393474945, 2.569206014161, 0.0557326614163}},
      {2, 1, {-1.0031111111111, -2.3414826608848, 0.335260438663, 0.2031211840927}},
      {3, 1, {0.3288888888889, -1.0708135815438, 1.728591359322, 0.9227097510296}},
      {3, 2, {1.3320000000000, 0.1026272312987, 2.561372768701, 0.0290975633252}}};
  const auto tukey = TukeyHsd::of(groups());
  ASSERT_TRUE(tukey);
  for (const Expected& expected : table) {
    const Difference difference = tukey->compare(expected.first, expected.second);
    EXPECT_NEAR(difference.estimate, expected.difference.estimate, 1e-12);
    EXPECT_NEAR(difference.low, expected.difference.low, 2e-4);
    EXPECT_NEAR(difference.high, expected.difference.high, 2e-4);
    EXPECT_NEAR(difference.p, expected.difference.p, 1e-9);
  }
}

//     t.test(a, d)    R's difference is the first minus the second.
TEST(AgainstR, WelchsTestFromSamples) {
  const auto test = welch_test(groups()[3], groups()[0]);
  ASSERT_TRUE(test);
  expect_relative(test->t, -2.12015453312380, 1e-12);
  expect_relative(test->degrees, 16.55744913429595, 1e-12);
  expect_relative(test->p, 0.04942100451859, 1e-11);
  expect_relative(test->low, -2.54304209364925, 1e-11);
  EXPECT_NEAR(test->high, -0.00362457301741, 1e-11);
}

//     mean(a); sd(a); mean(d); sd(d)
TEST(AgainstR, WelchsTestFromSummaries) {
  const auto from_summaries =
      welch_test(Moments::of_summary(6.796666666666667, 1.845270777534896, 12),
                 Moments::of_summary(5.523333333333333, 0.960940196165225, 12));
  ASSERT_TRUE(from_summaries);
  expect_relative(from_summaries->t, -2.12015453312380, 1e-12);
  expect_relative(from_summaries->p, 0.04942100451859, 1e-11);
}

TEST(Anova, SaysNothingWhereNothingCanBeSaid) {
  EXPECT_FALSE(one_way_anova(std::vector<Moments>{}));
  EXPECT_FALSE(one_way_anova(std::vector<Moments>(3)));
  EXPECT_FALSE(
      one_way_anova(std::vector{Moments::of_summary(1, 0, 1), Moments::of_summary(2, 0, 1)}))
      << "as many groups as values";
  EXPECT_FALSE(welch_test(Moments::of_summary(1, 0, 9), Moments::of_summary(2, 0, 9)));
  EXPECT_FALSE(welch_test(Moments::of_summary(1, 1, 1), Moments::of_summary(2, 1, 9)));
}

TEST(Anova, OfGroupsWithoutSpreadIsSettledByTheirMeans) {
  const std::vector<Moments> same(3, Moments::of_summary(1, 0, 9));
  EXPECT_EQ(one_way_anova(same)->p, 1);
  EXPECT_EQ(TukeyHsd::of(same)->compare(0, 1).p, 1);
  std::vector<Moments> apart = same;
  apart[2] = Moments::of_summary(2, 0, 9);
  EXPECT_EQ(one_way_anova(apart)->p, 0);
  EXPECT_EQ(TukeyHsd::of(apart)->compare(0, 1).p, 1);
  EXPECT_EQ(TukeyHsd::of(apart)->compare(0, 2).p, 0);
}

//     t.test(b, a, mu = -2, alternative = "greater")$p.value   8.05323048123e-07
//     t.test(b, a, mu =  2, alternative = "less")$p.value      0.0106909577173
//     t.test(b, a, conf.level = 0.9)$conf.int
TEST(AgainstR, EquivalenceByTwoOneSidedTests) {
  const auto test = equivalence_test(groups()[0], groups()[1], 2);
  ASSERT_TRUE(test);
  expect_relative(test->p, 0.0106909577173, 1e-8);
  expect_relative(test->low, 0.218843870832, 1e-8);
  expect_relative(test->high, 1.67004501806, 1e-8);
  EXPECT_TRUE(test->is_equivalent());
  EXPECT_FALSE(equivalence_test(groups()[0], groups()[1], 1)->is_equivalent());
  EXPECT_FALSE(equivalence_test(groups()[0], Moments(), 2)) << "of nothing";
}

//     x <- c(174.75, 84.09, 89.24, 85.11, 81.52, 84.09)   with a tie
//     y <- c(166.57, 92.83, 94.74, 95.39, 83.70, 90)
//     cor(x, y, method = "spearman"); cor(x, y, method = "kendall")
TEST(AgainstR, RankCorrelations) {
  const std::vector<double> x = {174.75, 84.09, 89.24, 85.11, 81.52, 84.09};
  const std::vector<double> y = {166.57, 92.83, 94.74, 95.39, 83.70, 90};
  expect_relative(*spearman_rho(x, y), 0.927633657044, 1e-11);
  expect_relative(*kendall_tau(x, y), 0.828078671211, 1e-11);
  EXPECT_FALSE(spearman_rho(x, std::vector<double>(6, 1.0)));
  EXPECT_FALSE(kendall_tau(std::vector<double>{1}, std::vector<double>{2}));
}

}  // namespace
}  // namespace culprit::study
