#include "study/statistics/moments.h"

#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::study {
namespace {

Moments of(const std::vector<double>& values) {
  Moments moments;
  for (const double value : values) moments.add(value);
  return moments;
}

// numpy.std([2, 4, 4, 4, 5, 5, 7, 9]) is 2; numpy.std(..., ddof=1) is 2.138089935299395.
TEST(Moments, KnowBothStandardDeviations) {
  const Moments moments = of({2, 4, 4, 4, 5, 5, 7, 9});
  EXPECT_EQ(moments.count(), 8);
  EXPECT_DOUBLE_EQ(moments.mean(), 5);
  EXPECT_DOUBLE_EQ(moments.population_sd(), 2);
  EXPECT_DOUBLE_EQ(moments.sample_sd(), 2.138089935299395);
}

TEST(Moments, OfFewValuesAreZeroNotNaN) {
  EXPECT_EQ(Moments().mean(), 0);
  EXPECT_EQ(Moments().population_sd(), 0);
  EXPECT_EQ(of({3}).population_sd(), 0);
  EXPECT_EQ(of({3}).sample_sd(), 0);
}

TEST(Moments, LoseNothingFarFromZero) {
  EXPECT_DOUBLE_EQ(of({1e9 + 4, 1e9 + 7, 1e9 + 13, 1e9 + 16}).sample_variance(), 30);
}

TEST(Moments, ComeBackFromAPublishedSummary) {
  const Moments moments = Moments::of_summary(1.01, 0.33, 162);
  EXPECT_DOUBLE_EQ(moments.mean(), 1.01);
  EXPECT_DOUBLE_EQ(moments.sample_sd(), 0.33);
}

RC_GTEST_PROP(Moments, OfTwoPartsMergeToThoseOfTheWhole, ()) {
  const auto values = *rc::gen::container<std::vector<int>>(rc::gen::inRange(-1000, 1000));
  const auto cut = *rc::gen::inRange<std::size_t>(0, values.size() + 1);
  Moments left;
  Moments right;
  Moments whole;
  for (std::size_t i = 0; i < values.size(); ++i) {
    (i < cut ? left : right).add(values[i]);
    whole.add(values[i]);
  }
  left.merge(right);
  RC_ASSERT(left.count() == whole.count());
  RC_ASSERT(std::abs(left.mean() - whole.mean()) < 1e-9);
  RC_ASSERT(std::abs(left.squared_deviations() - whole.squared_deviations()) <
            1e-9 * (1 + whole.squared_deviations()));
}

}  // namespace
}  // namespace culprit::study
