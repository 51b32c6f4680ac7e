#include "plan/paper_planner.h"

#include <algorithm>
#include <tuple>

#include "plan/beside_exhausted.h"
#include "plan/cost.h"
#include "plan/ties.h"
#include "plan/validity.h"

namespace culprit {

std::vector<Decision> PaperPlanner::plan(std::span<const RuleId> failures,
                                         const Knowledge& knowledge) const {
  std::vector<Decision> decisions;
  std::vector<ComponentId> affected;
  if (!switches_.criticality) {
    select(failures, Criticality::kNonCritical, knowledge, affected, decisions);
    return decisions;
  }
  for (const Criticality level :
       {Criticality::kError, Criticality::kWarning, Criticality::kNonCritical}) {
    std::vector<RuleId> of_level;
    std::copy_if(failures.begin(), failures.end(), std::back_inserter(of_level),
                 [&](RuleId id) { return knowledge.rules[id].policies.criticality == level; });
    select(of_level, level, knowledge, affected, decisions);
  }
  return decisions;
}

double PaperPlanner::cost(const Strategy& strategy, StrategyId id,
                          const Knowledge& knowledge) const {
  const Probability success = knowledge.beliefs[id].mean();
  return switches_.impact ? plan::cost(success, strategy.impact, knowledge.rules.heaviest)
                          : plan::cost_without_impact(success);
}

void PaperPlanner::select(std::span<const RuleId> failures, Criticality level,
                          const Knowledge& knowledge, std::vector<ComponentId>& affected,
                          std::vector<Decision>& decisions) const {
  const RuleSet& rules = knowledge.rules;
  std::vector<Candidate> candidates;
  for (const RuleId failure : failures) {
    for (const StrategyId id : rules[failure].strategies)
      candidates.push_back({id, cost(rules[id], id, knowledge), {}, {}, {}, {}, 0, 0});
  }
  std::sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    const auto key = [&](const Candidate& c) {
      const Strategy& strategy = rules[c.strategy];
      return std::tuple<std::int64_t, const std::string&, const std::string&>(
          plan::parts(c.cost), rules[strategy.rule].name, strategy.name);
    };
    return key(a) < key(b);
  });

  std::vector<Decision> found;
  for (const RuleId failure : failures) found.push_back({failure, {}, true, {}, {}});
  const auto decision_about = [&](RuleId rule) {
    return std::lower_bound(found.begin(), found.end(), rule,
                            [](const Decision& v, RuleId r) { return v.rule < r; });
  };
  for (Candidate& candidate : candidates) {
    const auto decision = decision_about(rules[candidate.strategy].rule);
    examine(candidate, level, knowledge, affected);
    // What is affected by the strategy chosen for the same failure is rather excluded by that
    // choice itself.
    const bool is_free = !candidate.excluded || candidate.excluded == Condition::kAffected;
    if (is_free && decision->chosen) candidate.excluded = Condition::kOneEach;
    if (!candidate.excluded) {
      decision->chosen = candidate.strategy;
      const auto& adapted = rules[candidate.strategy].components;
      affected.insert(affected.end(), adapted.begin(), adapted.end());
    }
    const bool is_out =
        candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid;
    decision->is_spent &= is_out;
    decision->candidates.push_back(std::move(candidate));
  }
  decisions.insert(decisions.end(), std::make_move_iterator(found.begin()),
                   std::make_move_iterator(found.end()));
}

void PaperPlanner::examine(Candidate& candidate, Criticality level, const Knowledge& knowledge,
                           const std::vector<ComponentId>& affected) const {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  if (knowledge.states.is_tried(candidate.strategy)) {
    candidate.excluded = Condition::kTried;
    return;
  }
  if (auto invalid = plan::invalidity(strategy, knowledge)) {
    candidate.excluded = invalid->is_unheard ? Condition::kUnheard : Condition::kInvalid;
    candidate.component = invalid->component;
    candidate.remark = std::move(invalid->reason);
    return;
  }
  if (const auto& reason = knowledge.withheld[candidate.strategy.index].reason; !reason.empty()) {
    candidate.excluded = Condition::kWithheld;
    candidate.component = strategy.components.front();
    candidate.remark = reason;
    return;
  }
  for (const ComponentId component : strategy.components) {
    candidate.component = component;
    if (knowledge.states.reservation(component) != nullptr) {
      candidate.excluded = Condition::kAdapting;
      return;
    }
    if (std::find(affected.begin(), affected.end(), component) != affected.end()) {
      candidate.excluded = Condition::kAffected;
      return;
    }
  }
  if (switches_.dependencies && depends_on_cause(candidate, level, knowledge)) {
    candidate.excluded = Condition::kDependency;
  }
}

bool PaperPlanner::depends_on_cause(Candidate& candidate, Criticality level,
                                    const Knowledge& knowledge) const {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  if (strategy.is_last_resort) return false;
  const RuleStates& states = knowledge.states;
  for (const ComponentId component : strategy.components) {
    const auto sick = knowledge.graph.first_upstream(component, [&](ComponentId upstream) {
      return states.is_sick(upstream, level, strategy.rule);
    });
    if (!sick) continue;
    candidate.component = *sick;
    candidate.failure = states.sickness(*sick, level, strategy.rule);
    return true;
  }
  const bool has_to_wait = !states.exhausted().empty() &&
                           !plan::may_be_tried_beside_exhausted(candidate.strategy, knowledge);
  if (!has_to_wait) return false;
  for (const ComponentId component : strategy.components) {
    const auto waiting = knowledge.graph.first_upstream(component, [&](ComponentId upstream) {
      return states.awaiting_person_at(upstream, level, strategy.rule).has_value();
    });
    if (!waiting) continue;
    candidate.component = *waiting;
    candidate.failure = states.awaiting_person_at(*waiting, level, strategy.rule);
    return true;
  }
  return false;
}

}  // namespace culprit
