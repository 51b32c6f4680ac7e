// How a learned success probability comes closer to the true rate, experiment by experiment.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "study/statistics/moments.h"

namespace culprit::study {

// Of one strategy. Probabilities are in [0, 1].
struct LearningCurve {
  std::string failure;  // "F1"
  std::string rule;
  std::string strategy;
  double initial = 0;  // what the designer believed
  double truth = 0;    // how often it ends the fault, of the times that it was learned from
  // After the first, second, ... experiment; each over the repetitions of the whole series.
  std::vector<Moments> learned;
  double executed = 0;  // how often in a series, on average
  double counted = 0;   // as often it was learned from
  // How often it ends the fault in all of its executions; the truth, too, if it was never learned
  // from. It is another number if executions that cannot be judged differ from the others: beside
  // an outage that hides whether it helped, other faults are there than without one. A learned rate
  // can be compared only with the executions that were observed.
  double truth_of_all = 0;
  double confidence = 0;  // how many outcomes the designer's belief is worth
  std::string planner{};  // that executed it
  // Executions of a series that were not learned from, by the reason.
  double hidden = 0;     // a more critical failure was there before the outcome counted
  double beside = 0;     // something else can have had the same effect, or nothing was changed
  double undecided = 0;  // the run ended first
  // The share of all executions after which the failure was gone: what is estimated if every
  // verdict counts at once, as in the paper.
  double verdicts = 0;

  // The belief at the end, and its distance from the truth.
  double believed() const { return learned.empty() ? initial : learned.back().mean(); }
  double error() const { return std::abs(believed() - truth); }
  // The part of that which is what the designer believed: it weighs as much as `confidence`
  // outcomes, so that after few a wrong one is still there.
  double error_of_prior() const {
    const double weight = confidence + counted;
    return weight == 0 ? 0 : confidence * std::abs(initial - truth) / weight;
  }
  // By which the outcomes of one series miss the truth by chance.
  double standard_error() const {
    return counted == 0 ? 0 : std::sqrt(truth * (1 - truth) / counted);
  }
};

}  // namespace culprit::study
