// The searches that earlier processes of culprit left off (RuleState::left_off): which failures were
// there, and what was tried for them. So a restart of culprit begins no search anew.
#pragma once

#include "knowledge/history.h"
#include "knowledge/knowledge.h"

namespace culprit {

// No strategy of the rounds counts as tried any more. Last resorts are no part of the rounds.
void forget_tried(const Rule& rule, const RuleSet& rules, Search& search);

class LeftOffSearches {
 public:
  // Both must outlive it.
  LeftOffSearches(const Knowledge& knowledge, RuleStates& states)
      : knowledge_(knowledge), states_(states) {}

  // An event of an earlier process. In the order of time, before anything is analyzed.
  void remember(const Event& event);
  // The failure is detected now: what was left off counts, unless the failure had been proven gone.
  void detected(RuleId id, Time now);

 private:
  void remember_detected(RuleId id, Time at);
  void remember_gone(RuleId id, Time at, Duration quiet);
  void remember_tried(StrategyId strategy);
  bool is_proven(Time gone, Time now) const;

  const Knowledge& knowledge_;
  RuleStates& states_;
};

}  // namespace culprit
