#include "study/statistics/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/invariant.h"

namespace culprit::study {
namespace {

// From 1; equal numbers share the mean of their ranks.
std::vector<double> ranks(std::span<const double> values) {
  std::vector<double> ranks;
  for (const double value : values) {
    const auto below =
        std::count_if(values.begin(), values.end(), [&](double v) { return v < value; });
    const auto equal = std::count(values.begin(), values.end(), value);
    ranks.push_back(static_cast<double>(below) + (static_cast<double>(equal) + 1) / 2);
  }
  return ranks;
}

int sign(double x) { return (x > 0) - (x < 0); }

}  // namespace

std::optional<double> spearman_rho(std::span<const double> a, std::span<const double> b) {
  CULPRIT_ASSERT(a.size() == b.size());
  const std::vector<double> ranks_a = ranks(a);
  const std::vector<double> ranks_b = ranks(b);
  const double mean = (static_cast<double>(a.size()) + 1) / 2;
  double products = 0;
  double squares_a = 0;
  double squares_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    products += (ranks_a[i] - mean) * (ranks_b[i] - mean);
    squares_a += (ranks_a[i] - mean) * (ranks_a[i] - mean);
    squares_b += (ranks_b[i] - mean) * (ranks_b[i] - mean);
  }
  if (squares_a == 0 || squares_b == 0) return std::nullopt;
  return products / std::sqrt(squares_a * squares_b);
}

std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b) {
  CULPRIT_ASSERT(a.size() == b.size());
  double balance = 0;
  double pairs_a = 0;  // that are no ties
  double pairs_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const int in_a = sign(a[i] - a[j]);
      const int in_b = sign(b[i] - b[j]);
      balance += in_a * in_b;
      pairs_a += in_a != 0 ? 1 : 0;
      pairs_b += in_b != 0 ? 1 : 0;
    }
  }
  if (pairs_a == 0 || pairs_b == 0) return std::nullopt;
  return balance / std::sqrt(pairs_a * pairs_b);
}

}  // namespace culprit::study
