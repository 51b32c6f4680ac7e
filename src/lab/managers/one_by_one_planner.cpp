#include "managers/one_by_one_planner.h"

#include <algorithm>

#include "plan/validity.h"

namespace culprit::study {
namespace {

StrategyId likeliest(const Rule& rule, const RuleSet& rules) {
  return *std::max_element(
      rule.strategies.begin(), rule.strategies.end(),
      [&](StrategyId a, StrategyId b) { return rules[a].success.value < rules[b].success.value; });
}

Candidate examined(StrategyId id, StrategyId only, bool is_busy, const Knowledge& knowledge) {
  Candidate candidate;
  candidate.strategy = id;
  if (id != only) {
    candidate.excluded = Condition::kOneEach;
  } else if (knowledge.states.is_tried(id)) {
    candidate.excluded = Condition::kTried;
  } else if (const auto invalid = plan::invalidity(knowledge.rules[id], knowledge)) {
    candidate.excluded = Condition::kInvalid;
    candidate.component = invalid->component;
    candidate.remark = invalid->reason;
  } else if (is_busy) {
    candidate.excluded = Condition::kAdapting;
    candidate.component = knowledge.rules[id].components.front();
  }
  return candidate;
}

}  // namespace

std::vector<Decision> OneByOnePlanner::plan(std::span<const RuleId> failures,
                                            const Knowledge& knowledge) const {
  const auto& active = knowledge.states.active();
  bool is_busy = std::any_of(active.begin(), active.end(),
                             [&](RuleId id) { return knowledge.states[id].attempt.has_value(); });
  std::vector<Decision> decisions;
  for (const RuleId id : failures) {
    const Rule& rule = knowledge.rules[id];
    const StrategyId only = likeliest(rule, knowledge.rules);
    Decision decision;
    decision.rule = id;
    for (const StrategyId each : rule.strategies)
      decision.candidates.push_back(examined(each, only, is_busy, knowledge));
    const auto found =
        std::find_if(decision.candidates.begin(), decision.candidates.end(),
                     [&](const Candidate& candidate) { return candidate.strategy == only; });
    if (!found->excluded) decision.chosen = only;
    decision.is_spent = found->excluded == Condition::kTried;
    is_busy |= decision.chosen.has_value();
    decisions.push_back(std::move(decision));
  }
  return decisions;
}

}  // namespace culprit::study
