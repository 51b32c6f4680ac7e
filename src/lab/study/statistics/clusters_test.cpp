#include "study/statistics/clusters.h"

#include <vector>

#include <gtest/gtest.h>

namespace culprit::study {
namespace {

Moments independent(const std::vector<std::vector<double>>& clusters) {
  Moments all;
  Clusters by_cluster;
  for (const std::vector<double>& values : clusters) {
    double sum = 0;
    for (const double value : values) {
      all.add(value);
      sum += value;
    }
    by_cluster.add(sum, static_cast<double>(values.size()));
  }
  return by_cluster.independent(all);
}

TEST(Clusters, OfOneValueAreIndependent) {
  const Moments worth = independent({{1}, {2}, {4}, {9}});
  EXPECT_EQ(worth.count(), 4);
  EXPECT_DOUBLE_EQ(worth.mean(), 4);
}

// Each run twice is worth no more than each run once.
TEST(Clusters, OfEqualValuesAreWorthOneEach) {
  std::vector<std::vector<double>> clusters;
  for (int i = 0; i < 100; ++i) clusters.push_back({double(i), double(i)});
  const Moments worth = independent(clusters);
  EXPECT_NEAR(static_cast<double>(worth.count()), 100, 1);
  EXPECT_DOUBLE_EQ(worth.mean(), 49.5);
  EXPECT_NEAR(worth.sample_sd(), 28.94, 0.01);
}

TEST(Clusters, AreNeverWorthMoreThanTheirValues) {
  EXPECT_EQ(independent({{1, 9}, {9, 1}, {2, 8}}).count(), 6);
}

TEST(Clusters, ThatAreTooFewForATestAreTooFewAfterwards) {
  EXPECT_EQ(independent({}).count(), 0);
  EXPECT_EQ(independent({{1, 2, 3}}).count(), 1);
  EXPECT_EQ(independent({{1, 1}, {9, 9}}).count(), 2);
}

}  // namespace
}  // namespace culprit::study
