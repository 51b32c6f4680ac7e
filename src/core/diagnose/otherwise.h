// Which node would be the likeliest cause of node i if one piece of evidence were missing?
//
// The posterior of diagnosis.h is computed anew for i alone, with another pi_i, or another kappa(j -> i) g(j -> i) of one of its causes:
//
//     R_i'      = P'(own i) R_i / P(own i)
//     share_j'  = (1 - R_i') kappa'(j -> i) g'(j -> i) R_j / sum_k kappa'(k -> i) g'(k -> i) R_k
//
// All else stays as it was found: what i explains, and R_j. Twins (Diagnosis::twins) count as one cause here, too:
// the product and the sum take the one that explains i best then. Symbols: diagnosis.h.
#pragma once

#include <span>
#include <vector>

#include "diagnose/diagnosis.h"

namespace culprit::diagnose {

class Otherwise {
 public:
  // `diagnosis` must outlive it.
  Otherwise(std::size_t i, const Causes& causes, const Diagnosis& diagnosis);

  // As it was found.
  std::size_t likeliest() const { return likeliest_; }
  // If pi_i were `prior`.
  std::size_t with_prior(double prior) const { return likeliest(prior, kNone, 0); }
  // If node j, a cause of i, were not wrong.
  std::size_t without(std::size_t j) const { return likeliest(prior_, j, 0); }
  // If kappa(j -> i) g(j -> i) were `passes`.
  std::size_t if_passed(std::size_t j, double passes) const { return likeliest(prior_, j, passes); }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  struct Cause {
    std::size_t node = 0;
    double passes = 0;  // kappa g
    double own = 0;     // R_j
    std::span<const std::size_t> twins{};
  };
  std::size_t likeliest(double prior, std::size_t changed, double passes) const;

  std::size_t i_;
  double prior_;
  double in_loop_;  // R_i / P(own i)
  std::vector<Cause> causes_;
  std::size_t likeliest_;
};

}  // namespace culprit::diagnose
