#include "plan/paper_planner.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "base/invariant.h"
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
  const std::size_t first = decisions.size();
  for (const RuleId failure : failures) {
    decisions.push_back({failure, {}, true, {}, {}});
    decisions.back().candidates.reserve(rules[failure].strategies.size());
  }
  for (const Option& option : cheapest_first(failures, knowledge)) {
    Decision& decision = decisions[first + option.failure];
    Candidate& candidate = decision.candidates.emplace_back();
    candidate.strategy = option.strategy;
    candidate.cost = option.cost;
    examine(candidate, level, knowledge, affected, decision);
    // A candidate that is affected by the strategy chosen for the same failure is rather excluded
    // by that choice itself.
    const bool is_free = !candidate.excluded || candidate.excluded == Condition::kAffected;
    if (is_free && decision.chosen) candidate.excluded = Condition::kOneEach;
    if (!candidate.excluded) {
      CULPRIT_ASSERT(!decision.chosen);  // two strategies for one failure
      decision.chosen = candidate.strategy;
      const auto& adapted = rules[candidate.strategy].components;
      affected.insert(affected.end(), adapted.begin(), adapted.end());
    }
    const bool is_out =
        candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid;
    decision.is_spent &= is_out;
  }
}

std::vector<PaperPlanner::Option> PaperPlanner::cheapest_first(std::span<const RuleId> failures,
                                                               const Knowledge& knowledge) const {
  const RuleSet& rules = knowledge.rules;
  // Many cost the same. So that names need not be compared each time, each failure has its rank.
  std::vector<std::size_t> by_name(failures.size());
  std::iota(by_name.begin(), by_name.end(), std::size_t{0});
  std::sort(by_name.begin(), by_name.end(), [&](std::size_t a, std::size_t b) {
    return rules[failures[a]].name < rules[failures[b]].name;
  });
  std::vector<Option> options;
  for (std::size_t rank = 0; rank < by_name.size(); ++rank) {
    for (const StrategyId id : rules[failures[by_name[rank]]].strategies) {
      const double cost_of_it = cost(rules[id], id, knowledge);
      options.push_back({id, cost_of_it, by_name[rank], plan::parts(cost_of_it), rank});
    }
  }
  std::sort(options.begin(), options.end(), [&](const Option& a, const Option& b) {
    const auto key = [&](const Option& o) {
      return std::tuple<std::int64_t, std::size_t, const std::string&>(o.parts, o.rank,
                                                                       rules[o.strategy].name);
    };
    return key(a) < key(b);
  });
  return options;
}

void PaperPlanner::examine(Candidate& candidate, Criticality level, const Knowledge& knowledge,
                           const std::vector<ComponentId>& affected,
                           const Decision& decision) const {
  if (plan::is_excluded_alone(candidate, knowledge)) return;
  for (const ComponentId component : knowledge.rules[candidate.strategy].components) {
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
  if (!switches_.dependencies) return;
  if (depends_like_another(candidate, decision, knowledge) ||
      depends_on_cause(candidate, level, knowledge))
    candidate.excluded = Condition::kDependency;
}

// Another strategy of the failure at the same components was found to depend on a failing one: so
// does this one, and the graph need not be searched again.
bool PaperPlanner::depends_like_another(Candidate& candidate, const Decision& decision,
                                        const Knowledge& knowledge) const {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  for (const Candidate& other : decision.candidates) {
    const bool is_for_failing = other.failure && knowledge.states.is_active(*other.failure);
    if (other.excluded != Condition::kDependency || !is_for_failing ||
        knowledge.rules[other.strategy].components != strategy.components)
      continue;
    candidate.component = other.component;
    candidate.failure = other.failure;
    return true;
  }
  return false;
}

bool PaperPlanner::depends_on_cause(Candidate& candidate, Criticality level,
                                    const Knowledge& knowledge) const {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
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
