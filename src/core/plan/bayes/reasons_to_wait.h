// Why a strategy is not begun now, as far as that does not depend on what else is begun: the failure
// is the effect of another one, may be the echo of one, or will likely clear by itself; a cause upstream may
// still be detected; its components are taken.
#pragma once

#include "diagnose/examination.h"
#include "plan/bayes/likely_causes.h"
#include "plan/bayes/value.h"
#include "plan/bayes/weighed_candidate.h"

namespace culprit::plan {

class ReasonsToWait {
 public:
  // All must outlive it.
  ReasonsToWait(const Knowledge& knowledge, const CostWeights& weights,
                const diagnose::Examination& found, const LikelyCauses& likely,
                const Exclusions& exclusions)
      : knowledge_(knowledge),
        weights_(weights),
        found_(found),
        causes_(found.causes()),
        diagnosis_(found.diagnosis()),
        likely_(likely),
        exclusions_(exclusions) {}

  // Excludes a valid strategy that has to wait. `chance` is u of the strategy.
  void look_at(WeighedCandidate& weighed, double chance) const;
  // Excludes one that is invalid now.
  void look_at(WeighedCandidate& weighed, const Invalid& why) const;

 private:
  bool exclude_effect(WeighedCandidate& weighed) const;
  void exclude_for(WeighedCandidate& weighed, std::size_t cause) const;
  bool is_about_to_fire(RuleId other, RuleId failure) const;
  bool exclude_coincidence(WeighedCandidate& weighed) const;
  bool exclude_unproven(WeighedCandidate& weighed, double chance) const;
  bool exclude_transient(WeighedCandidate& weighed) const;
  bool exclude_beside_held(WeighedCandidate& weighed) const;
  // It waits until then at the latest, if that is known.
  void ends(WeighedCandidate& weighed, Time until) const {
    if (until > knowledge_.now && until != kNever)
      weighed.candidate.within = until - knowledge_.now;
  }
  bool is_settling(RuleId rule) const;
  bool is_sure(RuleId rule) const;
  bool ends_wait_of(StrategyId strategy, std::size_t cause) const;
  bool opens_way_for(StrategyId strategy, std::size_t cause) const;
  bool is_held_for_a_moment(std::size_t cause) const;
  bool is_quicker_than_repair(StrategyId strategy, std::size_t cause) const;

  const Knowledge& knowledge_;
  const CostWeights& weights_;
  const diagnose::Examination& found_;
  const diagnose::Causes& causes_;        // of found_
  const diagnose::Diagnosis& diagnosis_;  // likewise
  const LikelyCauses& likely_;
  const Exclusions& exclusions_;
};

}  // namespace culprit::plan
