#include "diagnose/otherwise.h"

#include <algorithm>

namespace culprit::diagnose {

Otherwise::Otherwise(std::size_t i, const Causes& causes, const Diagnosis& diagnosis)
    : i_(i),
      prior_(diagnosis.prior(i)),
      in_loop_(diagnosis.of(i) / diagnosis.against_others(i)),
      likeliest_(i) {
  for_each(causes.causes(i), [&](std::size_t j) {
    causes_.push_back(
        {j, diagnosis.kappa(j, i) * causes.timely(j, i), diagnosis.of(j), diagnosis.twins(j)});
  });
  likeliest_ = likeliest(prior_, kNone, 0);
}

std::size_t Otherwise::likeliest(double prior, std::size_t changed, double passes) const {
  const auto pass_of = [&](const Cause& each) {
    return each.node == changed ? passes : each.passes;
  };
  // As Diagnosis counts them: of twins only the one that explains i best.
  const auto has_better_twin = [&](const Cause& each) {
    return std::ranges::any_of(each.twins, [&](std::size_t node) {
      const auto twin = std::ranges::find(causes_, node, &Cause::node);
      return twin != causes_.end() && (pass_of(*twin) > pass_of(each) ||
                                       (pass_of(*twin) == pass_of(each) && node < each.node));
    });
  };
  double unexplained = 1;
  double claims = 0;
  double most = 0;
  std::size_t first = i_;
  for (const Cause& each : causes_) {
    if (has_better_twin(each)) continue;
    const double pass = pass_of(each);
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
