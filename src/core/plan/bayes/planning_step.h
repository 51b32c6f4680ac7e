// One planning step of the bayes planner, with everything that it works out on the way.
#pragma once

#include <span>
#include <vector>

#include "diagnose/examination.h"
#include "diagnose/questions.h"
#include "plan/bayes/conflict_free_set.h"
#include "plan/bayes/exclusions.h"
#include "plan/bayes/levels.h"
#include "plan/bayes/likely_causes.h"
#include "plan/bayes/reasons_to_wait.h"
#include "plan/bayes/side_by_side.h"
#include "plan/bayes/value.h"
#include "plan/bayes/weighed_candidate.h"
#include "plan/planner.h"

namespace culprit::plan {

class PlanningStep {
 public:
  // All must outlive it.
  PlanningStep(std::span<const RuleId> failures, const Knowledge& knowledge,
               const CostWeights& weights);

  std::vector<Decision> run();

 private:
  std::vector<RuleId> worked_on() const;
  void find_stakes();
  void examine_all();
  void examine(std::size_t failure);
  std::vector<Try> tries_of(std::size_t failure, const std::vector<StrategyChance>& chances) const;
  double disruption(const Strategy& strategy) const;
  void revive();
  void go_round();
  void select(Criticality level);
  void choose(const WeighedCandidate& weighed);
  void await_answers();
  void ask_suspects();
  void await(ComponentId component, WeighedCandidate& weighed) const;
  void ask_again();
  std::vector<WeighedCandidate*> chosen_together(const std::vector<WeighedCandidate*>& open) const;
  std::vector<WeighedCandidate*> weigh_together(const std::vector<WeighedCandidate*>& open,
                                                const std::vector<WeighedCandidate*>& chosen) const;
  std::optional<StrategyId> done_for_another(const WeighedCandidate& weighed,
                                             const std::vector<WeighedCandidate*>& chosen) const;
  void leave_to(RuleId other, std::size_t failure,
                const std::vector<WeighedCandidate*>& open) const;
  bool is_taken(WeighedCandidate& weighed) const;
  std::vector<Decision> decisions();
  bool is_before(const WeighedCandidate& a, const WeighedCandidate& b) const;

  const Knowledge& knowledge_;
  const CostWeights& weights_;
  std::vector<RuleId> planned_;
  diagnose::Examination found_;
  const diagnose::Causes& causes_;        // of found_
  const diagnose::Diagnosis& diagnosis_;  // likewise
  LikelyCauses likely_;
  Levels levels_;
  Exclusions exclusions_;
  ReasonsToWait reasons_;
  diagnose::Questioner questioner_;
  std::vector<double> stakes_;  // by failure: W_i + sum_k share(i -> k) W_k
  std::vector<WeighedCandidate> weighed_;
  std::vector<WeighedCandidate*> best_first_;
  std::vector<bool> has_choice_;                // by failure
  std::vector<std::vector<Try>> tries_;         // by failure: what is left, in the order of u/c
  std::vector<Side> sides_;                     // of what was chosen so far
  std::vector<std::vector<ComponentId>> asks_;  // by failure: Decision::asks
};

}  // namespace culprit::plan
