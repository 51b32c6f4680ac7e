// One planning step of the bayes planner, with everything that it works out on the way.
#pragma once

#include <span>
#include <vector>

#include "diagnose/examination.h"
#include "plan/bayes/conflict_free_set.h"
#include "plan/bayes/exclusions.h"
#include "plan/bayes/levels.h"
#include "plan/bayes/side_by_side.h"
#include "plan/bayes/strategy_chances.h"
#include "plan/bayes/value.h"
#include "plan/planner.h"

namespace culprit::plan {

class PlanningStep {
 public:
  // All must outlive it.
  PlanningStep(std::span<const RuleId> failures, const Knowledge& knowledge,
               const CostWeights& weights);

  std::vector<Decision> run();

 private:
  // A strategy of a failure that is to be decided about.
  struct WeighedCandidate {
    Candidate candidate;
    std::size_t failure = 0;    // index in causes_
    Criticality level{};        // of the failure
    std::int64_t worth = 0;     // plan/ties.h
    std::int64_t cost = 0;      // the same
    std::size_t place = 0;      // among tries_ of the failure
    bool only_revives = false;  // waits for no other failure
    bool goes_round = false;    // is done beside the repair of its cause
    Exclusions::Places affected;
  };

  std::vector<std::vector<StrategyChance>> all_chances() const;
  std::vector<RuleId> worked_on() const;
  bool waits_for_person(std::size_t failure) const;
  bool is_left_to_person(std::size_t node) const;
  std::optional<std::size_t> cause_of(std::size_t failure) const;
  std::vector<std::optional<ComponentId>> all_unheard() const;
  std::optional<ComponentId> unheard_behind(std::size_t failure) const;
  void find_stakes();
  void examine_all();
  void examine(std::size_t failure);
  std::vector<Try> tries_of(std::size_t failure, const std::vector<StrategyChance>& chances) const;
  double disruption(const Strategy& strategy) const;
  void exclude(WeighedCandidate& weighed, double chance) const;
  void exclude(WeighedCandidate& weighed, const Exclusions::Obstacle& obstacle) const;
  void exclude_invalid(WeighedCandidate& weighed, const Invalid& why) const;
  bool exclude_effect(WeighedCandidate& weighed) const;
  bool exclude_coincidence(WeighedCandidate& weighed) const;
  bool exclude_unproven(WeighedCandidate& weighed, double chance) const;
  bool exclude_transient(WeighedCandidate& weighed) const;
  bool is_sure(RuleId rule) const;
  void exclude_for(WeighedCandidate& weighed, std::size_t cause) const;
  bool ends_wait_of(StrategyId strategy, std::size_t cause) const;
  bool is_quicker_than_repair(StrategyId strategy, std::size_t cause) const;
  void revive();
  void go_round();
  void select(Criticality level);
  void choose(const WeighedCandidate& weighed);
  void await_answers();
  void ask_again();
  std::vector<WeighedCandidate*> chosen_together(const std::vector<WeighedCandidate*>& open) const;
  std::vector<WeighedCandidate*> weigh_together(const std::vector<WeighedCandidate*>& open,
                                                const std::vector<WeighedCandidate*>& chosen) const;
  bool is_taken(WeighedCandidate& weighed) const;
  std::optional<ComponentId> missing_member(RuleId rule) const;
  ComponentId likeliest_component(RuleId rule) const;
  ComponentId component_of(std::size_t node) const;
  std::vector<Suspect> suspects(std::size_t failure) const;
  std::vector<Decision> decisions();
  bool is_before(const WeighedCandidate& a, const WeighedCandidate& b) const;

  const Knowledge& knowledge_;
  const CostWeights& weights_;
  std::vector<RuleId> planned_;
  diagnose::Examination found_;
  const diagnose::Causes& causes_;        // of found_
  const diagnose::Diagnosis& diagnosis_;  // likewise
  // By node: the component on an unreachable computer that it is about, or can have spread from. It
  // explains the failure for sure; a learned coupling does not.
  std::vector<std::optional<ComponentId>> unheard_;
  Levels levels_;
  std::vector<std::vector<StrategyChance>> chances_;  // by failure, of those to be decided about
  Exclusions exclusions_;
  std::vector<double> stakes_;  // by failure: W_i + sum_k share(i -> k) W_k
  std::vector<WeighedCandidate> weighed_;
  std::vector<WeighedCandidate*> best_first_;
  std::vector<bool> has_choice_;                // by failure
  std::vector<std::vector<Try>> tries_;         // by failure: what is left, in the order of u/c
  std::vector<Side> sides_;                     // of what was chosen so far
  std::vector<std::vector<ComponentId>> asks_;  // by failure: Decision::asks
};

}  // namespace culprit::plan
