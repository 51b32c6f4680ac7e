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

std::optional<double> spearman_p(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t kMany = 9;
  const std::optional<double> rho = spearman_rho(a, b);
  if (!rho || a.size() > kMany) return std::nullopt;
  const std::vector<double> fixed = ranks(a);
  std::vector<double> moved = ranks(b);
  std::sort(moved.begin(), moved.end());
  const double mean = (static_cast<double>(a.size()) + 1) / 2;
  double own = 0;
  const std::vector<double> present = ranks(b);
  for (std::size_t i = 0; i < fixed.size(); ++i) own += (fixed[i] - mean) * (present[i] - mean);
  // Orders of equal ranks are all visited once, which leaves the share as it is.
  double orders = 0;
  double as_far = 0;
  do {
    double products = 0;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      products += (fixed[i] - mean) * (moved[i] - mean);
    orders += 1;
    as_far += std::abs(products) >= std::abs(own) - 1e-9 ? 1 : 0;
  } while (std::next_permutation(moved.begin(), moved.end()));
  return as_far / orders;
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
