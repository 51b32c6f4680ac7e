// What would have to be different for another strategy to be chosen?
//
// Every answer was tried: it is a change with which the planner, asked anew, chooses that strategy
// for the same failure. It says nothing about how a planner works, so it serves any.
#pragma once

#include <vector>

#include "plan/planner.h"
#include "plan/what_if.h"

namespace culprit::plan {

// Copies the knowledge once, and plans once for each change that it tries: some fifty times for
// each strategy that is asked about.
class FlipFinder {
 public:
  // `failures` as for Planner::plan(). `planner` must outlive the finder.
  FlipFinder(const Planner& planner, std::vector<RuleId> failures, const Knowledge& knowledge);

  // The decisions without any change.
  const std::vector<Decision>& decisions() const { return decisions_; }

  // The changes with which `loser` is chosen. First those of numbers, the smallest first: a change
  // of a success probability by 10 % is as large as one of an impact by a tenth of the heaviest, as
  // in the paper's Eq. 1. Probabilities are found to a tenth of a percent, impacts to a cycle: one
  // less does not do. Then those of circumstances.
  // @pre a decision has `loser` among its candidates and has not chosen it
  std::vector<Change> flips(StrategyId loser);

 private:
  // One plan, as far as it is about the loser.
  struct Outcome {
    bool is_chosen = false;
    std::optional<StrategyId> rival;  // chosen instead of it
    std::optional<RuleId> hindrance;  // another failure that keeps it from being chosen
    std::optional<Condition> excluded;
    ComponentId component;  // that the condition is about
  };
  Outcome outcome(const std::vector<Decision>& decisions, StrategyId loser) const;
  Outcome outcome_with(const Change& change, StrategyId loser);
  bool wins_with(const Change& change, StrategyId loser) {
    return outcome_with(change, loser).is_chosen;
  }

  std::optional<Change> success_of(StrategyId changed, int end, StrategyId loser);
  std::optional<Change> impact(StrategyId loser);
  std::optional<Change> resolved(const Outcome& now, StrategyId loser);
  std::vector<Change> circumstances(const Outcome& now, StrategyId loser) const;
  double size(const Change& change) const;

  const Planner& planner_;
  std::vector<RuleId> failures_;
  WhatIf what_if_;
  std::vector<Decision> decisions_;
};

}  // namespace culprit::plan
