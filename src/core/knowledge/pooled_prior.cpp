#include "knowledge/pooled_prior.h"

#include <algorithm>
#include <cmath>

#include "base/log_gamma.h"

namespace culprit {
namespace {

// Robots of one model differ about as much as a Beta of precision 20 does.
constexpr double kUsualCorrelation = 1.0 / 21;
constexpr double kCorrelationWeight = 3;  // in robots
constexpr double kModelWeight = 10;       // what another model is worth at most, in outcomes
constexpr double kMostCorrelation = 0.9;

struct Share {
  double helped = 0;
  double tried = 0;
};

Share share_of(double helped, double failed) {
  const double tried = helped + failed;
  const double scale = tried > kMostOfOneRobot ? kMostOfOneRobot / tried : 1;
  return {helped * scale, tried * scale};
}

bool is_possible(const RobotOutcomes& sums) {
  constexpr double kMost = 1e12;
  constexpr double kRounding = 1e-6;
  const double slack = kRounding * (1 + sums.tried);
  return std::isfinite(sums.robots) && std::isfinite(sums.spread) && std::isfinite(sums.square) &&
         sums.robots > 0.5 && sums.tried > 0 && sums.tried < kMost && sums.helped >= -slack &&
         sums.helped <= sums.tried + slack && sums.spread >= -slack &&
         sums.spread <= sums.helped + slack && sums.square > 0 &&
         sums.tried <= kMostOfOneRobot * sums.robots + slack;
}

double mean_of(const RobotOutcomes& sums) { return std::clamp(sums.helped / sums.tried, 0.0, 1.0); }

// rho, of all models together: each says how much its own robots differ.
double correlation(const RobotOutcomes& sums) {
  const double degrees = sums.robots - 1;
  const double within = sums.tried - sums.robots;
  if (degrees < 0.5 || within < 0.5) return kUsualCorrelation;
  const double msb = (sums.spread - sums.helped * sums.helped / sums.tried) / degrees;
  const double msw = (sums.helped - sums.spread) / within;
  const double n0 = (sums.tried - sums.square / sums.tried) / degrees;
  const double total = msb + (n0 - 1) * msw;
  // All outcomes are the same: the robots do not differ.
  const double seen = total > 1e-12 ? std::clamp((msb - msw) / total, 0.0, kMostCorrelation) : 0;
  return (kCorrelationWeight * kUsualCorrelation + degrees * seen) / (kCorrelationWeight + degrees);
}

// In outcomes of a robot that has none yet.
double worth(const RobotOutcomes& sums, double rho) {
  const double size = std::max(1.0, sums.square / sums.tried);
  return sums.tried / (1 + (size - 1) * rho);
}

struct Mean {
  double value = 0;
  double weight = 0;
  void add(double other, double its_weight) {
    weight += its_weight;
    if (weight > 0) value += (other - value) * its_weight / weight;
  }
};

double log_beta(double a, double b) { return log_gamma(a) + log_gamma(b) - log_gamma(a + b); }

}  // namespace

void RobotOutcomes::add(double more_helped, double more_failed) {
  const Share share = share_of(more_helped, more_failed);
  if (share.tried <= 0) return;
  robots += 1;
  tried += share.tried;
  helped += share.helped;
  spread += share.helped * share.helped / share.tried;
  square += share.tried * share.tried;
}

void RobotOutcomes::remove(double less_helped, double less_failed) {
  const Share share = share_of(less_helped, less_failed);
  if (share.tried <= 0) return;
  if (robots < 1.5) {
    *this = {};
    return;
  }
  robots -= 1;
  tried = std::max(0.0, tried - share.tried);
  helped = std::clamp(helped - share.helped, 0.0, tried);
  spread = std::clamp(spread - share.helped * share.helped / share.tried, 0.0, helped);
  square = std::max(tried * tried / robots, square - share.tried * share.tried);
}

RobotOutcomes& RobotOutcomes::operator+=(const RobotOutcomes& other) {
  robots += other.robots;
  tried += other.tried;
  helped += other.helped;
  spread += other.spread;
  square += other.square;
  return *this;
}

Belief pooled_prior(const Belief& designer, const RobotOutcomes& model,
                    std::span<const RobotOutcomes> others, const Pooling& pooling) {
  const double confidence = designer.alpha + designer.beta;
  const bool has_model = is_possible(model);
  const double rho = has_model ? correlation(model) : kUsualCorrelation;

  double outcomes = 0;  // of the fleet, worth of
  Mean mean{designer.mean().value, std::min(confidence, kModelWeight)};
  for (const RobotOutcomes& other : others) {
    if (!is_possible(other)) continue;
    const double weight = std::min(kModelWeight, worth(other, correlation(other)));
    mean.add(mean_of(other), weight);
    outcomes += weight;
  }
  mean.weight = std::min(mean.weight, kModelWeight);
  if (has_model) {
    mean.add(mean_of(model), worth(model, rho));
    outcomes += worth(model, rho);
  }
  if (outcomes <= 0) return designer;

  const double precision = 1 / (rho + (1 - rho) / (mean.weight + 1)) - 1;
  const double fleet = outcomes / (confidence + outcomes);
  const double strength = (1 - fleet) * confidence + fleet * std::min(precision, pooling.most);
  // As a designer's 0 or 100 %, a fleet's can be unlearned.
  constexpr double kLeastCount = 0.05;
  return {std::max(kLeastCount, strength * mean.value),
          std::max(kLeastCount, strength * (1 - mean.value))};
}

double agreement(const Belief& prior, double helped, double failed) {
  double tried = helped + failed;
  if (tried <= 0) return 1;
  // More would say no more, and take longer.
  constexpr double kMost = 1000;
  if (tried > kMost) {
    helped = std::round(helped * kMost / tried);
    tried = kMost;
  }
  const double scale = log_beta(prior.alpha, prior.beta);
  const auto log_probability = [&](double s) {
    return log_gamma(tried + 1) - log_gamma(s + 1) - log_gamma(tried - s + 1) +
           log_beta(prior.alpha + s, prior.beta + tried - s) - scale;
  };
  constexpr double kTie = 1e-9;
  const double own = log_probability(helped) + kTie;
  double sum = 0;
  for (double s = 0; s <= tried; ++s) {
    const double each = log_probability(s);
    if (each <= own) sum += std::exp(each);
  }
  return std::min(1.0, sum);
}

}  // namespace culprit
