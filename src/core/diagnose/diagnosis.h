// Which component has a cause of its own? For each node (causes.h) the probability that it is not
// only the effect of others: explaining away (docs/planning.md).
//
//     P(own i) = pi_i / (pi_i + (1 - pi_i) X_i),    X_i = 1 - prod_j (1 - kappa(j -> i) g(j -> i))
//
//   i           a node
//   j           the nodes that may be its cause
//   kappa       how surely i clears when j is resolved (knowledge/couplings.h)
//   g           how likely i came so late after j (Causes::timely)
//   X_i         the probability that one of the others explains i; 0 (so P = 1) if there is none.
//               Failures that wait for a person and are about the same component are one cause: of
//               these, the product takes only the one with the highest kappa g
//   pi_i        the probability that i has a cause of its own, before anything else is known of it:
//               kKnownDown if a strategy of i would replace a process that the operating system
//               says is gone or stopped, or that hangs by itself (known_down.h), and for troubles;
//               kCoincidence otherwise
//
// This is the posterior of a noisy-or: any present cause is enough, and i's own is one of them.
//
// In a feedback loop one of the nodes was first. Member i of loop C is it with probability omega_i,
// and otherwise has a cause of its own only by coincidence:
//
//     omega_i = w_i / sum_{k in C} w_k
//     w_i     = a_i (pi_i / pi) 1 / (1 + delay_i) prod_{k in C, k != i} kappa(i -> k) / kappa0
//     R_i     = P(own i) (omega_i + (1 - omega_i) pi)
//
//   a_i                 how likely a fault at i would have survived all that was tried there
//                       (still_there.h): a component that was adapted in vain is less likely
//   delay_i             how much later than the first onset of the loop its onset was, in cycles
//   kappa(i -> k)       how well it explains the others
//   pi, kappa0          kCoincidence and Coupling::kUsual
//
// Source: the noisy-or and its explaining away are Pearl's (Probabilistic Reasoning in Intelligent
// Systems, 1988, section 4.3.2); the rest is ours.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnose/causes.h"

namespace culprit::diagnose {

inline constexpr double kCoincidence = 0.05;
inline constexpr double kKnownDown = 0.95;

// P(own i) from pi_i and X_i.
double own_cause(double prior, double explained);

class Diagnosis {
 public:
  // Both must outlive it.
  Diagnosis(const Knowledge& knowledge, const Causes& causes);

  // R_i: 1 if nothing else can be the cause of node i.
  double of(std::size_t i) const { return own_[i]; }
  // P(own i) alone: what others outside its loop leave unexplained.
  double against_others(std::size_t i) const { return against_others_[i]; }
  // The same, as if `no_causes` could not be the cause of it.
  double against_others(std::size_t i, std::span<const std::size_t> no_causes) const;
  // pi_i
  double prior(std::size_t i) const { return prior_[i]; }
  // Other failures that wait for a person with j and are about one of its components; empty if j waits for none.
  std::span<const std::size_t> twins(std::size_t j) const { return twins_[j]; }
  // kappa(j -> i)
  double kappa(std::size_t j, std::size_t i) const;
  // Until when the process that node i is about may hang only because a supplier answers nothing. kLongAgo:
  // none is down; kNever: as long as one is.
  Time may_wait_until(std::size_t i) const;
  // X_i, as if `no_causes` could not be the cause of i.
  double explained(std::size_t i, std::span<const std::size_t> no_causes = {}) const;
  // Is j alone enough for i to have no cause of its own, more likely than not?
  bool is_explained_by(std::size_t i, std::size_t j) const;
  // The node of i's loop that is evident, if it is alone enough for i: the members need not take turns. None if a process of
  // i's own is dead.
  std::optional<std::size_t> evident_in_loop(std::size_t i) const;
  // The part of 1 - R_i (which others explain) that falls to node j: in proportion to kappa(j -> i)
  // g(j -> i) R_j; 0 if X_i does not take j.
  double share(std::size_t j, std::size_t i) const;
  // The same for all causes of i outside its loop: calls visit(j, share).
  template <class Visit>
  void for_each_share(std::size_t i, Visit visit) const {
    for_each(causes_.causes(i), [&](std::size_t j) { visit(j, share(j, i)); });
  }

 private:
  bool is_known_dead(std::size_t i) const;
  // A process of it is dead, or it reads that a component is not active, which is no effect of data.
  bool is_evident(std::size_t i) const;
  // Node i is a rule about a process that hangs, and waits for no other one that is down.
  bool hangs_by_itself(std::size_t i) const;
  bool is_enough(std::size_t j, std::size_t i) const;
  // kappa g
  double passes(std::size_t j, std::size_t i) const { return kappa(j, i) * causes_.timely(j, i); }
  void find_twins();
  // Is there a twin of j that explains i better, or as well and comes first?
  bool has_better_twin(std::size_t j, std::size_t i) const;
  void divide(const std::vector<std::size_t>& loop);
  double weight(std::size_t i, const std::vector<std::size_t>& loop, Time first) const;

  const Knowledge& knowledge_;
  const Causes& causes_;
  std::vector<std::vector<std::size_t>> twins_;  // by node
  std::vector<double> prior_;                    // pi_i
  std::vector<double> against_others_;
  std::vector<double> own_;
  std::vector<double> claims_;  // of node i: the sum of kappa(j -> i) g(j -> i) R_j over its causes
};

}  // namespace culprit::diagnose
