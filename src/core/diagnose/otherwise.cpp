#include "diagnose/otherwise.h"

namespace culprit::diagnose {

Otherwise::Otherwise(std::size_t i, const Causes& causes, const Diagnosis& diagnosis)
    : i_(i),
      prior_(diagnosis.prior(i)),
      in_loop_(diagnosis.of(i) / diagnosis.against_others(i)),
      likeliest_(i) {
  for_each(causes.causes(i), [&](std::size_t j) {
    causes_.push_back({j, diagnosis.kappa(j, i) * causes.timely(j, i), diagnosis.of(j)});
  });
  likeliest_ = likeliest(prior_, kNone, 0);
}

std::size_t Otherwise::likeliest(double prior, std::size_t changed, double passes) const {
  double unexplained = 1;
  double claims = 0;
  double most = 0;
  std::size_t first = i_;
  for (const Cause& each : causes_) {
    const double pass = each.node == changed ? passes : each.passes;
    unexplained *= 1 - pass;
    claims += pass * each.own;
    if (pass * each.own <= most) continue;
    most = pass * each.own;
    first = each.node;
  }
  const double own = own_cause(prior, 1 - unexplained) * in_loop_;
  return claims > 0 && (1 - own) * most / claims > own ? first : i_;
}

}  // namespace culprit::diagnose
