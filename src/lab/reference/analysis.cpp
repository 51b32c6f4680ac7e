#include "reference/analysis.h"

#include <algorithm>

#include "reference/impacts.h"

namespace culprit::study::reference {

Analysis::Analysis(const RuleSet& rules, const ReferenceOptions& options)
    : rules_(rules),
      states_(rules.rules.size()),
      tried_(rules.strategies.size()),
      healths_(rules.components.size(), Criticality::kNonCritical),
      sent_(rules.rules.size(), options.seed) {}

void Analysis::advance(Time now, std::span<const StrategyId> chosen, std::span<const Slot> signals,
                       std::vector<Event>& events) {
  for (State& state : states_) {
    if (state.phase == Phase::kAdapted) ++state.counter;
  }
  for (const StrategyId strategy : chosen) {
    const RuleId rule = rules_[strategy].rule;
    tried_[strategy.index] = true;
    states_[rule.index].phase = Phase::kAdapted;
    states_[rule.index].last = strategy;
    states_[rule.index].counter = -highest_impact(rules_[strategy]).count;
    sent_.erase(rule);
  }
  for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
    const Slot trigger = evaluate(rules_.rules[r].trigger, signals);
    look_at(RuleId(r), trigger.known && trigger.b, now, events);
  }
}

void Analysis::look_at(RuleId id, bool triggered, Time now, std::vector<Event>& events) {
  // n of the reference's filter "n of k results", which is always 1 here.
  constexpr std::int64_t kNeeded = 1;
  const State& state = states_[id.index];
  const bool is_adapted = state.phase == Phase::kAdapted;
  if (triggered) {
    if (state.phase == Phase::kQuiet) detect(id, now, events);
    if (is_adapted && state.counter > kNeeded) fail(id, now, events);
  } else if (state.phase == Phase::kSent) {
    resolve(id, FailureResolved::How::kWithoutStrategy, now, events);
  } else if (is_adapted && (state.counter < 0 || state.counter >= kNeeded)) {
    resolve(id, FailureResolved::How::kByStrategy, now, events);
  }
}

void Analysis::detect(RuleId id, Time now, std::vector<Event>& events) {
  const Rule& rule = rules_[id];
  for (const StrategyId strategy : rule.strategies) tried_[strategy.index] = false;
  states_[id.index] = {Phase::kSent, 0, {}, now};
  sent_.insert(id);
  set_health(id, rule.policies.criticality);
  events.push_back({now, FailureDetected{id}});
}

void Analysis::fail(RuleId id, Time now, std::vector<Event>& events) {
  State& state = states_[id.index];
  events.push_back({now, StrategyFailed{*state.last, "the failure is still there"}});
  state.phase = Phase::kSent;
  sent_.insert(id);
  const auto& strategies = rules_[id].strategies;
  if (std::all_of(strategies.begin(), strategies.end(), [&](StrategyId s) { return is_tried(s); }))
    events.push_back({now, RuleExhausted{id}});
}

void Analysis::resolve(RuleId id, FailureResolved::How how, Time now, std::vector<Event>& events) {
  State& state = states_[id.index];
  const bool by_strategy = how == FailureResolved::How::kByStrategy;
  events.push_back({now, FailureResolved{id, how, by_strategy ? state.last : std::nullopt,
                                         now - state.detected}});
  state.phase = Phase::kQuiet;
  sent_.erase(id);
  set_health(id, Criticality::kNonCritical);
}

void Analysis::set_health(RuleId id, Criticality health) {
  for (const ComponentId component : rules_[id].components) healths_[component.index] = health;
}

}  // namespace culprit::study::reference
