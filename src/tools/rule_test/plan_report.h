// A plan with its reasons, for people and for programs (docs/plan.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "json/json.h"
#include "plan/decision.h"

namespace culprit::rule_test {

struct PlanReport {
  // Finds the decisions, and what would flip them. A strategy that the governor withholds is not
  // chosen; if none may begin now, `held_back` says why. `knowledge` must outlive the report.
  PlanReport(const Planner& planner, std::vector<RuleId> failures, const Knowledge& plan_knowledge,
             const std::optional<std::string>& held_back);

  const Knowledge& knowledge;
  std::vector<plan::ExplainedDecision> decisions;
  std::optional<Time> now;  // nothing: how long a failure has been there means nothing
};

std::string plan_as_text(const PlanReport& report);
Json plan_as_json(const PlanReport& report);

// Why a strategy was not chosen; null for the one that was.
Json exclusion_as_json(const Candidate& candidate, const RuleSet& rules);

}  // namespace culprit::rule_test
