// Do several groups have the same mean (one-way ANOVA), and which two differ (Tukey's HSD)?
//
//     SS_between = sum_i n_i (mean_i - mean)^2,   SS_within = sum_i M2_i
//     F = (SS_between / (k - 1)) / (SS_within / (N - k))
//
// Tukey's honestly significant difference compares pairs so that the chance of any false alarm
// among all of them stays at alpha; with unequal group sizes it is Tukey-Kramer's:
//
//     q = |mean_j - mean_i| / sqrt(MS_within / 2 (1 / n_i + 1 / n_j)),   p = P(Q_{k, N-k} > q)
//
// Moments are all that is needed of a group, so no value is kept. Checked against R's aov and
// TukeyHSD.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "study/statistics/moments.h"

namespace culprit::study {

struct Anova {
  double f = 0;
  double degrees_between = 0;
  double degrees_within = 0;
  double mean_square_within = 0;
  double p = 1;
};

// Empty if there are fewer than two groups, an empty one, or no more values than groups. Groups
// without any spread inside: f is infinite and p 0 if their means differ, f 0 and p 1 if not.
std::optional<Anova> one_way_anova(std::span<const Moments> groups);

struct Difference {
  double estimate = 0;  // mean of the second minus mean of the first
  double low = 0;       // of the simultaneous confidence interval
  double high = 0;
  double p = 1;  // corrected
};

class TukeyHsd {
 public:
  // `alpha` in (0, 1): 1 - alpha is the joint confidence of all intervals.
  // Empty if one_way_anova is.
  static std::optional<TukeyHsd> of(std::vector<Moments> groups, double alpha = 0.05);

  // @pre both are indices of `groups`
  Difference compare(std::size_t first, std::size_t second) const;

  const Anova& anova() const { return anova_; }

 private:
  TukeyHsd(std::vector<Moments> groups, Anova anova, double alpha);

  std::vector<Moments> groups_;
  Anova anova_;
  double critical_q_ = 0;
};

}  // namespace culprit::study
