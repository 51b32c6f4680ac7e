#include "study/statistics/distribution.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::study {
namespace {

// The smallest value that a share `q` of all does not exceed.
double quantile(const Distribution& distribution, double q) {
  std::int64_t wanted = static_cast<std::int64_t>(q * static_cast<double>(distribution.count()));
  for (const auto& [value, count] : distribution.counts()) {
    wanted -= count;
    if (wanted <= 0) return value;
  }
  return distribution.counts().rbegin()->first;
}

TEST(Distribution, IsExactForFewValues) {
  Distribution distribution;
  for (const double value : {2.0, -1.0, 0.1, 2.0, -0.0, 0.0}) distribution.add(value);
  EXPECT_EQ(distribution.counts(),
            (std::map<double, std::int64_t>{{-1, 1}, {0, 2}, {0.1, 1}, {2, 2}}));
}

TEST(Distribution, KeepsManyValuesInLittleMemoryWithASmallError) {
  std::mt19937 engine(1);
  std::vector<double> values(100'000);
  for (double& value : values) value = 1 + static_cast<double>(engine()) * 0x1p-32 * 9;
  Distribution distribution;
  for (const double value : values) distribution.add(value);
  EXPECT_LE(distribution.counts().size(), Distribution::kMostValues);
  EXPECT_EQ(distribution.count(), 100'000);
  std::sort(values.begin(), values.end());
  for (const double q : {0.01, 0.25, 0.5, 0.9, 0.999}) {
    const double exact = values[static_cast<std::size_t>(q * 100'000) - 1];
    EXPECT_NEAR(quantile(distribution, q), exact, 0.01 * exact);
  }
}

RC_GTEST_PROP(Distribution, DoesNotDependOnTheOrder, (std::uint32_t seed)) {
  std::mt19937 engine(seed);
  std::vector<double> values(3000);
  for (double& value : values)
    value =
        std::ldexp(static_cast<double>(engine()) - 0x1p31, static_cast<int>(engine() % 40) - 50);
  const auto counts = [&values] {
    Distribution distribution;
    for (const double value : values) distribution.add(value);
    return distribution.counts();
  };
  const auto before = counts();
  std::shuffle(values.begin(), values.end(), engine);
  RC_ASSERT(counts() == before);
}

}  // namespace
}  // namespace culprit::study
