// Who is responsible? For each failure, the probability that it has a cause of its own and is not
// only the effect of others: explaining away (docs/planning.md).
//
//     P(root i) = pi_i / (pi_i + (1 - pi_i) X_i),    X_i = 1 - prod_j (1 - kappa(j -> i))
//
//   i           a failure that is there
//   j           the failures that may be its cause (plan/bayes/failures.h)
//   kappa       how surely i goes away when j is resolved (knowledge/couplings.h)
//   X_i         the probability that one of the others explains i; 0 (so P = 1) if there is none
//   pi_i        the probability that i has a cause of its own, before anything else is known of it:
//               kSeenDown if a strategy of i would replace a process that the operating system
//               says is gone or stopped, kCoincidence otherwise
//
// This is the posterior of a noisy-or: any present cause is enough, and i's own is one of them.
//
// In a circle of failures that may cause each other, one of them was first. Member i of circle C is
// it with probability omega_i, and otherwise has a cause of its own only by coincidence:
//
//     omega_i = w_i / sum_{k in C} w_k
//     w_i     = a_i (pi_i / pi) 1 / (1 + delay_i) prod_{k in C, k != i} kappa(i -> k) / kappa0
//     R_i     = P(root i) (omega_i + (1 - omega_i) pi)
//
//   a_i                 how likely it is that a fault at i would have survived all that was tried
//                       there (plan/bayes/strategy_chances.h): a component that was adapted in
//                       vain is less likely to be the cause
//   delay_i             how much later than the first failure of the circle it was detected, in
//                       cycles (its first detection, if it comes and goes)
//   kappa(i -> k)       how well it explains the others
//   pi, kappa0          kCoincidence and Coupling::kUsual
//
// Source: the noisy-or and its explaining away are Pearl's (Probabilistic Reasoning in Intelligent
// Systems, 1988, section 4.3.2); the rest is ours.
#pragma once

#include <optional>
#include <vector>

#include "plan/bayes/failures.h"

namespace culprit::plan {

inline constexpr double kCoincidence = 0.05;
inline constexpr double kSeenDown = 0.95;

// P(root i) from pi_i and X_i.
double root_probability(double prior, double explained);

class Responsibility {
 public:
  // Both must outlive it.
  Responsibility(const Knowledge& knowledge, const Failures& failures);

  // R_i: 1 if nothing else can be the cause of failure i.
  double of(std::size_t i) const { return root_[i]; }
  // P(root i) alone: what others outside its circle leave unexplained.
  double against_others(std::size_t i) const { return against_others_[i]; }
  // kappa(j -> i)
  double kappa(std::size_t j, std::size_t i) const;
  // Is j alone enough for i to have no cause of its own, more likely than not?
  bool is_explained_by(std::size_t i, std::size_t j) const;
  // The failure of i's circle that has a dead process, if it is alone enough for i. The operating
  // system told who was first there, so nobody need find out by taking turns. None if a process of
  // i's own is dead.
  std::optional<std::size_t> dead_in_circle(std::size_t i) const;
  // Of the part 1 - R_i that others explain, what falls to failure j: in proportion to
  // kappa(j -> i) R_j.
  double share(std::size_t j, std::size_t i) const;
  // The same for all causes of i outside its circle: calls visit(j, share).
  template <class Visit>
  void for_each_share(std::size_t i, Visit visit) const {
    for_each(failures_.causes(i), [&](std::size_t j) { visit(j, share(j, i)); });
  }

 private:
  bool is_enough(std::size_t j, std::size_t i) const;
  double explained(std::size_t i) const;
  void divide(const std::vector<std::size_t>& circle);
  double weight(std::size_t i, const std::vector<std::size_t>& circle, Time first) const;

  const Knowledge& knowledge_;
  const Failures& failures_;
  std::vector<double> own_;  // pi_i
  std::vector<double> against_others_;
  std::vector<double> root_;
  std::vector<double> claims_;  // of failure i: the sum of kappa(j -> i) R_j over its causes
};

}  // namespace culprit::plan
