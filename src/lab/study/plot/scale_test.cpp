#include "study/plot/scale.h"

#include <gtest/gtest.h>

#include "study/plot/histogram.h"

namespace culprit::study {
namespace {

TEST(Scale, PutsValuesInTheirPlace) {
  const Scale scale{0, 10, 100, 0};
  EXPECT_DOUBLE_EQ(scale(0), 100);
  EXPECT_DOUBLE_EQ(scale(2.5), 75);
}

TEST(Ticks, AreRound) {
  EXPECT_EQ(ticks(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  EXPECT_EQ(ticks(-3, 9, 6), (std::vector<double>{-2, 0, 2, 4, 6, 8}));
  EXPECT_EQ(tick_label(0.6000000000000001), "0.6");
  EXPECT_EQ(tick_label(-0.0), "0");
}

TEST(Histogram, CountsWithinAndBeyondItsBins) {
  Distribution distribution;
  for (const double value : {-1.0, 0.0, 0.5, 1.0, 1.99, 2.0, 7.0}) distribution.add(value);
  const Histogram counts = histogram(distribution, {0, 1, 2});
  EXPECT_EQ(counts.counts, (std::vector<std::int64_t>{3, 2}));
  EXPECT_EQ(counts.beyond, 2);
  EXPECT_EQ(counts.highest(), 3);
}

}  // namespace
}  // namespace culprit::study
