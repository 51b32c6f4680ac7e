#include "reference/planning.h"

#include <algorithm>

namespace culprit::study::reference {

Planning::Planning(const RuleSet& rules, const ReferenceOptions& options)
    : rules_(rules),
      switches_(options.switches),
      cost_(rules, options),
      reserved_(rules.components.size()),
      decisions_(rules.rules.size()),
      said_(rules.rules.size()) {}

const std::vector<StrategyId>& Planning::advance(Time now, const Analysis& analysis,
                                                 const Execution& execution, const Graph& graph,
                                                 std::vector<Event>& events) {
  chosen_.clear();
  for (std::size_t c = 0; c < reserved_.size(); ++c) {
    if (execution.is_busy(ComponentId(c))) reserved_[c] = false;
  }
  for (const Criticality level :
       {Criticality::kError, Criticality::kWarning, Criticality::kNonCritical})
    select(level, {analysis, execution, graph});
  tell(now, analysis.sent(), events);
  return chosen_;
}

std::vector<Candidate> Planning::candidates(Criticality level, const Analysis& analysis) const {
  std::vector<Candidate> all;
  for (const RuleId failure : analysis.sent()) {
    if (rules_[failure].policies.criticality != level) continue;
    for (const StrategyId id : rules_[failure].strategies)
      all.push_back({id, cost_(id, rules_[id].success), {}, {}, {}, {}});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  return all;
}

void Planning::select(Criticality level, const Present& present) {
  std::vector<Candidate> all = candidates(level, present.analysis);
  for (const Candidate& candidate : all) decisions_[rules_[candidate.strategy].rule.index].clear();
  for (Candidate& candidate : all) {
    const Strategy& strategy = rules_[candidate.strategy];
    auto& decision = decisions_[strategy.rule.index];
    examine(candidate, level, present);
    const bool has_one = std::any_of(decision.begin(), decision.end(),
                                     [](const Candidate& c) { return !c.excluded; });
    // If a component is reserved for the strategy chosen for the same failure, the reason given is
    // that choice.
    const bool is_free = !candidate.excluded || candidate.excluded == Condition::kAffected;
    if (has_one && is_free) candidate.excluded = Condition::kOneEach;
    if (!candidate.excluded) {
      chosen_.push_back(candidate.strategy);
      for (const ComponentId component : strategy.components) reserved_[component.index] = true;
    }
    decision.push_back(std::move(candidate));
  }
}

void Planning::examine(Candidate& candidate, Criticality level, const Present& present) const {
  if (present.analysis.is_tried(candidate.strategy)) {
    candidate.excluded = Condition::kTried;
    return;
  }
  for (const ComponentId component : rules_[candidate.strategy].components) {
    candidate.component = component;
    if (present.execution.is_busy(component)) {
      candidate.excluded = Condition::kAdapting;
    } else if (reserved_[component.index]) {
      candidate.excluded = Condition::kAffected;
    } else if (switches_.dependencies && depends_on_sick(candidate, level, present)) {
      candidate.excluded = Condition::kDependency;
    }
    if (candidate.excluded) return;
  }
}

bool Planning::depends_on_sick(Candidate& candidate, Criticality level,
                               const Present& present) const {
  for (const ComponentId upstream : present.graph.upstream(candidate.component)) {
    if (present.analysis.health(upstream) < level) continue;
    if (!switches_.criticality && !reserved_[upstream.index]) continue;
    candidate.component = upstream;
    return true;
  }
  return false;
}

void Planning::tell(Time now, std::span<const RuleId> failures, std::vector<Event>& events) {
  for (const StrategyId strategy : chosen_) {
    const RuleId rule = rules_[strategy].rule;
    said_[rule.index].clear();
    events.push_back({now, StrategyChosen{strategy, decisions_[rule.index], {}, false}});
  }
  for (const RuleId failure : failures) {
    auto& decision = decisions_[failure.index];
    const bool is_chosen = std::any_of(decision.begin(), decision.end(),
                                       [](const Candidate& c) { return !c.excluded; });
    if (is_chosen || said_[failure.index] == decision) continue;
    said_[failure.index] = decision;
    events.push_back({now, FailureHeldBack{failure, decision}});
  }
}

}  // namespace culprit::study::reference
