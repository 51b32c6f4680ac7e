#include "study/claim.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/core.h>

#include "base/invariant.h"
#include "study/statistics/holm.h"
#include "study/statistics/welch.h"
#include "study/tables/columns.h"

namespace culprit::study {
namespace {

constexpr double kClaimAlpha = 0.05;

// A difference with its standard error; no error: there is no spread.
struct Gap {
  double difference = 0;
  double error = 0;
  double degrees = 0;
  bool is_known = false;  // two values or more on each side

  // P of a difference at least as far above `bound`, were the true one `bound`.
  double p_above(double bound) const {
    if (!is_known) return 1;
    if (error == 0) return difference > bound ? 0 : 1;
    const boost::math::students_t distribution(degrees);
    return cdf(boost::math::complement(distribution, (difference - bound) / error));
  }
  double p_below(double bound) const {
    return Gap{-difference, error, degrees, is_known}.p_above(-bound);
  }
  double p_within(double margin) const { return std::max(p_above(-margin), p_below(margin)); }
  // Either side may be the true one: with a margin of 0 it is the two-sided p.
  double p_beyond(double margin) const {
    const Gap largest{std::abs(difference), error, degrees, is_known};
    return std::min(1.0, largest.p_above(margin) + largest.p_above(-margin));
  }
};

// first - second
Gap gap(const Moments& first, const Moments& second) {
  Gap gap{first.mean() - second.mean(), 0, 1, first.count() >= 2 && second.count() >= 2};
  if (const auto test = welch_test(second, first)) {
    const auto squared_error = [](const Moments& of) {
      return of.sample_variance() / static_cast<double>(of.count());
    };
    gap.error = std::sqrt(squared_error(first) + squared_error(second));
    gap.degrees = test->degrees;
  }
  return gap;
}

Gap gap(const Moments& values, double bound) {
  const auto count = static_cast<double>(values.count());
  if (values.count() < 2) return {};
  return {values.mean() - bound, values.sample_sd() / std::sqrt(count), count - 1, true};
}

std::string named(const Group& group) { return group.name + " " + number(group.values.mean()); }

}  // namespace

double hedges_g(const Moments& a, const Moments& b) {
  const auto degrees = static_cast<double>(a.count() + b.count() - 2);
  if (degrees < 1) return 0;
  const double pooled = std::sqrt((a.squared_deviations() + b.squared_deviations()) / degrees);
  if (pooled == 0) return 0;
  return (b.mean() - a.mean()) / pooled * (1 - 3 / (4 * degrees - 1));
}

ClaimPart is_more(const Group& larger, const Group& smaller) {
  const Gap difference = gap(larger.values, smaller.values);
  return {fmt::format("{} > {}, g {}", named(larger), named(smaller),
                      number(hedges_g(smaller.values, larger.values))),
          difference.p_above(0),
          difference.p_below(0),
          Comparison::kMore,
          larger,
          smaller};
}

ClaimPart is_alike(const Group& ours, const Group& other, double margin) {
  const Gap difference = gap(ours.values, other.values);
  return {fmt::format("{} = {} ± {}, g {}", named(ours), named(other), number(margin),
                      number(hedges_g(other.values, ours.values))),
          difference.p_within(margin),
          difference.p_beyond(margin),
          Comparison::kAlike,
          ours,
          other,
          0,
          margin};
}

ClaimPart is_above(const Group& group, double bound) {
  const Gap difference = gap(group.values, bound);
  return {fmt::format("{} > {:g}", named(group), bound),
          difference.p_above(0),
          difference.p_below(0),
          Comparison::kAbove,
          group,
          {},
          bound};
}

ClaimPart is_below(const Group& group, double bound) {
  const Gap difference = gap(group.values, bound);
  return {fmt::format("{} < {:g}", named(group), bound),
          difference.p_below(0),
          difference.p_above(0),
          Comparison::kBelow,
          group,
          {},
          bound};
}

ClaimPart is_near(const Group& group, double bound, double margin) {
  const Gap difference = gap(group.values, bound);
  return {fmt::format("{} = {} ± {:g}", named(group), number(bound), margin),
          difference.p_within(margin),
          difference.p_beyond(margin),
          Comparison::kNear,
          group,
          {},
          bound,
          margin};
}

const ClaimPart& Claim::decisive() const {
  CULPRIT_ASSERT(!parts.empty());
  const bool is_against = verdict == Verdict::kContradicted;
  return *std::max_element(parts.begin(), parts.end(), [&](const auto& a, const auto& b) {
    return is_against ? a.p_against > b.p_against : a.p < b.p;
  });
}

std::size_t Claim::supported() const {
  return static_cast<std::size_t>(std::count_if(
      parts.begin(), parts.end(), [](const ClaimPart& part) { return part.p < kClaimAlpha; }));
}

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds:
      return "holds";
    case Verdict::kContradicted:
      return "contradicted";
    case Verdict::kOpen:
      break;
  }
  return "open";
}

void judge(std::vector<Claim>& claims) {
  std::vector<double> p;
  std::vector<double> p_against;
  for (const Claim& claim : claims) {
    CULPRIT_ASSERT(!claim.parts.empty());
    double largest = 0;
    double smallest = 1;
    for (const ClaimPart& part : claim.parts) {
      largest = std::max(largest, part.p);
      smallest = std::min(smallest, part.p_against);
    }
    p.push_back(largest);
    p_against.push_back(std::min(1.0, smallest * static_cast<double>(claim.parts.size())));
  }
  p = holm(p);
  p_against = holm(p_against);
  for (std::size_t i = 0; i < claims.size(); ++i) {
    claims[i].p = p[i];
    claims[i].p_against = p_against[i];
    claims[i].verdict = p[i] < kClaimAlpha           ? Verdict::kHolds
                        : p_against[i] < kClaimAlpha ? Verdict::kContradicted
                                                     : Verdict::kOpen;
  }
}

}  // namespace culprit::study
