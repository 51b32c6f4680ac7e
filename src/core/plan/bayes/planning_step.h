// One planning step of the bayes planner, with everything that it works out on the way.
#pragma once

#include <span>
#include <vector>

#include "plan/bayes/conflict_free_set.h"
#include "plan/bayes/levels.h"
#include "plan/bayes/remedies.h"
#include "plan/bayes/side_by_side.h"
#include "plan/bayes/surroundings.h"
#include "plan/bayes/value.h"
#include "plan/bayes/watchers.h"
#include "plan/planner.h"

namespace culprit::plan {

class PlanningStep {
 public:
  // All must outlive it.
  PlanningStep(std::span<const RuleId> failures, const Knowledge& knowledge,
               const CostWeights& weights);

  std::vector<Verdict> run();

 private:
  // A strategy of a failure that is to be decided about.
  struct Entry {
    Candidate candidate;
    std::size_t failure = 0;  // index in failures_
    std::int64_t worth = 0;   // plan/ties.h
    std::size_t place = 0;    // among tries_ of the failure
  };

  std::vector<std::vector<Remedy>> all_remedies() const;
  std::vector<RuleId> worked_on() const;
  bool waits_for_person(std::size_t failure) const;
  bool is_left_to_person(RuleId rule) const;
  std::optional<RuleId> cause_of(std::size_t failure) const;
  void find_stakes();
  void examine(std::size_t failure);
  std::vector<Option> options(std::size_t failure, const std::vector<Remedy>& remedies) const;
  double disruption(const Strategy& strategy) const;
  void exclude(Entry& entry, double chance) const;
  void exclude(Entry& entry, const Surroundings::Obstacle& obstacle) const;
  void exclude_invalid(Entry& entry, const Invalid& why) const;
  void exclude_effect(Entry& entry) const;
  void revive();
  void select(Criticality level);
  void choose(const Entry& entry);
  std::vector<Entry*> chosen_together(const std::vector<Entry*>& open) const;
  std::vector<Entry*> weigh_together(const std::vector<Entry*>& open,
                                     const std::vector<Entry*>& chosen) const;
  bool is_taken(Entry& entry) const;
  ComponentId likeliest_component(RuleId rule) const;
  std::vector<Suspect> suspects(std::size_t failure) const;
  std::vector<Verdict> verdicts();
  bool is_before(const Entry& a, const Entry& b) const;

  const Knowledge& knowledge_;
  const CostWeights& weights_;
  std::vector<RuleId> planned_;
  std::vector<RuleId> suspicious_;
  Reach reach_;
  Ways ways_;
  std::optional<Watchers> watchers_;  // while a failure is newborn
  Failures failures_;
  Responsibility responsibility_;
  Levels levels_;
  std::vector<std::vector<Remedy>> remedies_;  // by failure, of those to be decided about
  Surroundings surroundings_;
  std::vector<double> stakes_;  // by failure: W_i + sum_k share(i -> k) W_k
  std::vector<Entry> entries_;
  std::vector<bool> has_choice_;            // by failure
  std::vector<std::vector<Option>> tries_;  // by failure: what is left, in the order of u/c
  std::vector<Side> sides_;                 // of what was chosen so far
};

}  // namespace culprit::plan
