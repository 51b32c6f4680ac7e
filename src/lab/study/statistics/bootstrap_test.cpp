#include "study/statistics/bootstrap.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "study/statistics/moments.h"

namespace culprit::study {
namespace {

TEST(Bootstrap, DrawsTheSameForTheSameRun) {
  EXPECT_EQ(poisson_weights(1, 2, 3), poisson_weights(1, 2, 3));
  EXPECT_NE(poisson_weights(1, 2, 3), poisson_weights(1, 2, 4));
  EXPECT_NE(poisson_weights(1, 2, 3), poisson_weights(1, 3, 2));
  EXPECT_NE(poisson_weights(1, 2, 3), poisson_weights(1ULL << 40U, 2, 3));
}

TEST(Bootstrap, DrawsFromPoissonOfOne) {
  Moments weights;
  std::array<int, 3> few{};
  for (std::uint32_t run = 0; run < 1000; ++run) {
    for (const std::uint8_t weight : poisson_weights(7, 0, run)) {
      weights.add(weight);
      if (weight < few.size()) ++few[weight];
    }
  }
  EXPECT_NEAR(weights.mean(), 1, 0.005);
  EXPECT_NEAR(weights.sample_variance(), 1, 0.01);
  EXPECT_NEAR(few[0] / 1e6, 0.3679, 0.003);
  EXPECT_NEAR(few[1] / 1e6, 0.3679, 0.003);
  EXPECT_NEAR(few[2] / 1e6, 0.1839, 0.003);
}

// The interval of a normal sample's mean is known: mean +- 1.96 s / sqrt(n).
TEST(Bootstrap, AgreesWithTheNormalIntervalWhereThatHolds) {
  constexpr std::uint32_t kRuns = 400;
  std::mt19937 engine(5);
  Moments sample;
  BootstrapMean bootstrap;
  for (std::uint32_t run = 0; run < kRuns; ++run) {
    const double value =
        static_cast<double>(engine() % 1000) + static_cast<double>(engine() % 1000);
    sample.add(value);
    bootstrap.add(poisson_weights(1, 0, run), value, 1);
  }
  const double reach = 1.96 * sample.sample_sd() / std::sqrt(kRuns);
  const auto interval = bootstrap.interval();
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, sample.mean() - reach, 0.15 * reach);
  EXPECT_NEAR(interval->high, sample.mean() + reach, 0.15 * reach);
}

// Ten equal values of one run are no ten proofs.
TEST(Bootstrap, IsNotFooledByManyValuesOfOneRun) {
  BootstrapMean runs_of_one;
  BootstrapMean runs_of_ten;
  for (std::uint32_t run = 0; run < 100; ++run) {
    const Weights weights = poisson_weights(1, 0, run);
    runs_of_one.add(weights, run % 2, 1);
    runs_of_ten.add(weights, 10 * (run % 2), 10);
  }
  EXPECT_DOUBLE_EQ(runs_of_one.interval()->low, runs_of_ten.interval()->low);
  EXPECT_DOUBLE_EQ(runs_of_one.interval()->high, runs_of_ten.interval()->high);
}

TEST(Bootstrap, SaysNothingOfOneRun) {
  BootstrapMean bootstrap;
  EXPECT_FALSE(bootstrap.interval());
  bootstrap.add(poisson_weights(1, 0, 0), 1, 1);
  EXPECT_FALSE(bootstrap.interval());
}

}  // namespace
}  // namespace culprit::study
