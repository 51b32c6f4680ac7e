// Policies that choose among options by what each yielded before: multi-armed bandits.
//
// Three are those of ReBeT (strategies ucb_strategy and random_strategy, and the action egreedy),
// with the formulas and defaults of the library that it uses, masced_bandits 1.0.1:
//
//     ucb       every arm once, in order; then the largest   m_k + sqrt(ln n / n_k * V_k),
//               V_k = s_k - m_k^2 + sqrt(2 ln n / n_k)       ("UCB-Tuned" of Auer et al., 2002)
//     greedy    an arm of chance with probability 1/2, else the largest m_k; it never decays
//     random    an arm of chance
//
// with n_k plays of arm k, their mean m_k and mean square s_k, and n plays in all. The fourth is
// ours, for comparison with what culprit learns by its graph:
//
//     thompson  the largest of one draw for each arm from Beta(a_k, b_k): what is believed of it
//               first, and then its rewards (Thompson, 1933)
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/random.h"

namespace culprit::study {

enum class BanditPolicy : std::uint8_t { kUcb, kGreedy, kRandom, kThompson };

struct BanditArm {
  double prior_alpha = 1;  // of Thompson sampling
  double prior_beta = 1;
  double plays = 0;
  double rewards = 0;
  double squared_rewards = 0;

  void add(double reward);  // in [0, 1]
  double mean() const { return plays == 0 ? 0 : rewards / plays; }
};

// The arms, best first: what the policy would play, and what it would if that could not be played.
std::vector<std::size_t> ranked(BanditPolicy policy, const std::vector<BanditArm>& arms,
                                simulation::Random& random);

// A draw from Beta(alpha, beta), both > 0.
double draw_beta(double alpha, double beta, simulation::Random& random);

}  // namespace culprit::study
