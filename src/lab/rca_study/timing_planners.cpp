#include "rca_study/timing_planners.h"

#include <algorithm>

#include "rca_study/baselines.h"

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

constexpr Duration kReadings = 600ms;
constexpr Duration kPassingOn = 1s;

// The active rules, or the others, at components upstream of the failure's.
std::vector<RuleId> rules_upstream(RuleId failure, const Knowledge& knowledge) {
  const auto& components = knowledge.graph.upstream(knowledge.rules[failure].components);
  std::vector<RuleId> all;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const RuleId rule(r);
    const auto& own = knowledge.rules[rule].components;
    const bool is_upstream = std::any_of(own.begin(), own.end(), [&](ComponentId c) {
      return std::find(components.begin(), components.end(), c) != components.end();
    });
    if (is_upstream && rule != failure) all.push_back(rule);
  }
  return all;
}

}  // namespace

std::vector<Decision> TimingPlanner::plan(std::span<const RuleId> failures,
                                          const Knowledge& knowledge) const {
  std::vector<Decision> decisions;
  for (const RuleId failure : failures) {
    Decision& decision = decisions.emplace_back(cheapest_first(failure, knowledge));
    std::optional<RuleId> waits_for;
    auto why = Condition::kSuspect;
    if (knowledge.now < ripe(failure, knowledge)) waits_for = failure;
    for (const RuleId upstream : rules_upstream(failure, knowledge)) {
      const bool is_failing = knowledge.states.is_active(upstream);
      if (!is_failing && knowledge.now >= ripe(failure, upstream, knowledge)) continue;
      waits_for = is_failing ? upstream : failure;
      why = is_failing ? Condition::kDependency : Condition::kSuspect;
      if (is_failing) break;
    }
    for (Candidate& candidate : decision.candidates) {
      if (candidate.excluded) continue;
      if (waits_for) {
        candidate.excluded = why;
        candidate.component = knowledge.rules[*waits_for].components.front();
        candidate.failure = waits_for;
      } else if (decision.chosen) {
        candidate.excluded = Condition::kOneEach;
      } else {
        decision.chosen = candidate.strategy;
      }
    }
  }
  return decisions;
}

Time PatientPlanner::ripe(RuleId failure, const Knowledge& knowledge) const {
  return later(knowledge.states[failure].first_detected(), wait_);
}

Time PatientPlanner::ripe(RuleId, RuleId upstream, const Knowledge& knowledge) const {
  return later(knowledge.states[upstream].gone_since, wait_);
}

InformedPlanner::InformedPlanner(const RcaScenario& scenario) {
  for (const RcaComponent& component : scenario.components)
    latencies_.push_back(from_seconds(component.detector.latency_s));
}

Duration InformedPlanner::latency(RuleId rule, const Knowledge& knowledge) const {
  return latencies_[knowledge.rules[rule].components.front().index];
}

Time InformedPlanner::ripe(RuleId failure, const Knowledge& knowledge) const {
  return knowledge.states[failure].first_detected();
}

Time InformedPlanner::ripe(RuleId failure, RuleId upstream, const Knowledge& knowledge) const {
  const Duration own = latency(failure, knowledge);
  const Duration its = latency(upstream, knowledge);
  const Time shown = later(knowledge.states[failure].first_detected(), its - own + kReadings);
  const Time cleared = knowledge.states[upstream].gone_since;
  if (cleared == kLongAgo) return shown;
  return std::max(shown, later(cleared, own - its + kPassingOn + kReadings));
}

}  // namespace culprit::study::rca
