#include "study/statistics/anova.h"

#include <cmath>
#include <limits>

#include <boost/math/distributions/fisher_f.hpp>

#include "base/invariant.h"
#include "study/statistics/studentized_range.h"

namespace culprit::study {
namespace {

double share_beyond(double f, double degrees_between, double degrees_within) {
  using boost::math::complement;
  return cdf(complement(boost::math::fisher_f(degrees_between, degrees_within), f));
}

}  // namespace

std::optional<Anova> one_way_anova(std::span<const Moments> groups) {
  if (groups.size() < 2) return std::nullopt;
  Moments all;
  double within = 0;
  for (const Moments& group : groups) {
    if (group.count() == 0) return std::nullopt;
    all.merge(group);
    within += group.squared_deviations();
  }
  double between = 0;
  for (const Moments& group : groups)
    between += static_cast<double>(group.count()) * std::pow(group.mean() - all.mean(), 2);

  Anova anova;
  anova.degrees_between = static_cast<double>(groups.size()) - 1;
  anova.degrees_within = static_cast<double>(all.count()) - static_cast<double>(groups.size());
  if (anova.degrees_within < 1) return std::nullopt;
  anova.mean_square_within = within / anova.degrees_within;
  if (within == 0) {
    anova.f = between > 0 ? std::numeric_limits<double>::infinity() : 0;
    anova.p = between > 0 ? 0 : 1;
    return anova;
  }
  anova.f = between / anova.degrees_between / anova.mean_square_within;
  anova.p = share_beyond(anova.f, anova.degrees_between, anova.degrees_within);
  return anova;
}

std::optional<TukeyHsd> TukeyHsd::of(std::vector<Moments> groups, double alpha) {
  const std::optional<Anova> anova = one_way_anova(groups);
  if (!anova) return std::nullopt;
  return TukeyHsd(std::move(groups), *anova, alpha);
}

TukeyHsd::TukeyHsd(std::vector<Moments> groups, Anova anova, double alpha)
    : groups_(std::move(groups)),
      anova_(anova),
      critical_q_(studentized_range_quantile(alpha, static_cast<int>(groups_.size()),
                                             anova.degrees_within)) {}

Difference TukeyHsd::compare(std::size_t first, std::size_t second) const {
  CULPRIT_ASSERT(first < groups_.size() && second < groups_.size());
  const Moments& a = groups_[first];
  const Moments& b = groups_[second];
  Difference difference;
  difference.estimate = b.mean() - a.mean();
  const double per_value = 1 / static_cast<double>(a.count()) + 1 / static_cast<double>(b.count());
  const double error = std::sqrt(anova_.mean_square_within / 2 * per_value);
  difference.low = difference.estimate - critical_q_ * error;
  difference.high = difference.estimate + critical_q_ * error;
  if (error == 0) {
    difference.p = difference.estimate == 0 ? 1 : 0;
    return difference;
  }
  difference.p = studentized_range_tail(std::abs(difference.estimate) / error,
                                        static_cast<int>(groups_.size()), anova_.degrees_within);
  return difference;
}

}  // namespace culprit::study
