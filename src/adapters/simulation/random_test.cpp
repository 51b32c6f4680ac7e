#include "simulation/random.h"

#include <gtest/gtest.h>

namespace culprit::simulation {
namespace {

// The first outputs of SplitMix64 seeded with 0, as its authors publish them.
TEST(Mix, IsSplitMix64) {
  EXPECT_EQ(mix(0), 0xe220a8397b1dcdafU);
  EXPECT_EQ(mix(0x9e3779b97f4a7c15U), 0x6e789e6aa1b965f4U);
}

TEST(Random, DrawsTheSameFromTheSameSeed) {
  Random a(7);
  Random b(7);
  Random other(8);
  const std::uint64_t first = a.next();
  EXPECT_EQ(first, b.next());
  EXPECT_NE(first, other.next());
  EXPECT_NE(first, a.next());
}

TEST(Random, NormalHasZeroMeanAndUnitVariance) {
  Random random(1);
  constexpr int kDraws = 100'000;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double draw = random.normal();
    sum += draw;
    squares += draw * draw;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.015);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.02);
}

TEST(Random, UniformStaysInItsRange) {
  Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const double draw = random.uniform(-2, 3);
    ASSERT_GE(draw, -2);
    ASSERT_LT(draw, 3);
  }
}

}  // namespace
}  // namespace culprit::simulation
