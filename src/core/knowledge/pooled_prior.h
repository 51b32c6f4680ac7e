// The evidence that the outcomes of a fleet give for a robot that has few of its own: the belief
// that it begins with, and whether its own outcomes differ from the others'.
//
// Robots of one model are alike and not the same. Robot i tried a strategy n_i times, of which s_i
// helped; its true rate is drawn from a Beta distribution with mean mu and precision k. How much
// robots differ is measured by the intraclass correlation rho = 1 / (k + 1), estimated by the
// analysis of variance of binary outcomes (Ridout, Demetrio and Firth, Biometrics 55, 1999):
//
//     N = sum n_i   S = sum s_i   Q = sum s_i^2 / n_i   R = sum n_i^2   over r robots
//     MSB = (Q - S^2 / N) / (r - 1)      MSW = (S - Q) / (N - r)      n0 = (N - R / N) / (r - 1)
//     rho = (MSB - MSW) / (MSB + (n0 - 1) MSW)
//
// drawn towards kUsualCorrelation as if that many robots more had been seen (kCorrelationWeight).
// A group of robots with N outcomes gives as much information on its mean as N / (1 + (R / N - 1)
// rho) independent outcomes (the design effect): a thousand outcomes of one robot predict little of
// the next one.
//
//     fleet:  mean of the designer's belief and of each other model, each worth its outcomes and at
//             most kModelWeight
//     model:  mean of the fleet's and of the model's robots
//     robot:  precision 1 / (rho + (1 - rho) / (c + 1)) - 1, c being what the model's mean is worth,
//             and at most `most`: own outcomes soon outweigh it
//
// The designer's belief fades as outcomes come in: it keeps the share c_p / (c_p + outcomes).
// Sums can be added and taken away, so that a robot is given the prior of all the others.
#pragma once

#include <span>

#include "knowledge/beliefs.h"

namespace culprit {

// How several robots fared with one strategy.
struct RobotOutcomes {
  double robots = 0;  // r
  double tried = 0;   // N
  double helped = 0;  // S
  double spread = 0;  // Q
  double square = 0;  // R

  // One more robot. Counts for at most kMostOfOneRobot outcomes, in the same proportion.
  // @pre both are >= 0
  void add(double helped, double failed);
  // One less, which was added as it is now; or nearly so, for it may have grown since.
  void remove(double helped, double failed);
  RobotOutcomes& operator+=(const RobotOutcomes& other);
};

inline constexpr double kMostOfOneRobot = 50;

struct Pooling {
  double most = 12;  // pseudo-counts of the fleet's share of a prior
};

// The belief to begin with: to the last bit the designer's if there are no outcomes.
// `model`: the other robots of the same model; `others`: each other model. Sums that no outcomes
// can have count as none: they come from a network.
Belief pooled_prior(const Belief& designer, const RobotOutcomes& model,
                    std::span<const RobotOutcomes> others, const Pooling& pooling = {});

// How unlikely it is that a robot which is like `prior` fares so differently from it: the
// probability of an outcome that is as improbable as this one, or more so (beta-binomial, both
// sides). 1 without outcomes. @pre both are whole numbers >= 0
double agreement(const Belief& prior, double helped, double failed);

}  // namespace culprit
