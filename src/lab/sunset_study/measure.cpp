// The exemplar's evaluation script, and honest figures beside it.
#include <algorithm>
#include <set>

#include "sunset_study/run.h"

namespace culprit::study {
namespace {

// With D alone the script leaves out runs with more than these.
constexpr int kTolerableRedeployments = 2;

bool redeploys(const Strategy& strategy) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) { return a.type == AdaptationType::kRedeploy; });
}

bool restarts_or_redeploys(const Strategy& strategy) {
  return redeploys(strategy) ||
         std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) { return a.type == AdaptationType::kRestart; });
}

// The fault of the scenario that makes a node fall silent.
const sunset::Fault& outage(const sunset::Scenario& scenario) { return *scenario.faults.front(); }

bool needs_redeployment(const sunset::Fault& fault) { return fault.resolved_by.size() == 1; }

// The failures that were detected and never resolved. One that was lost sight of is not resolved.
std::int32_t unresolved(const SunsetRun& run) {
  std::set<RuleId> open;
  for (const Event& event : run.events) {
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      open.insert(detected->rule);
    if (const auto* resolved = std::get_if<FailureResolved>(&event.what))
      open.erase(resolved->rule);
  }
  return static_cast<std::int32_t>(open.size());
}

// Who is responsible for the outage? The components that were restarted or redeployed say what the
// manager thought.
RootCauses root_causes(const SunsetRun& run, const RuleSet& rules) {
  RootCauses causes;
  std::vector<ComponentId> blamed;
  for (const Event& event : run.events) {
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    if (chosen == nullptr || !restarts_or_redeploys(rules[chosen->strategy])) continue;
    for (const ComponentId component : rules[chosen->strategy].components)
      blamed.push_back(component);
  }
  const std::string culprit = sunset::node_of(outage(run.scenario).member).full();
  causes.asked = 1;
  causes.top_right = !blamed.empty() && rules[blamed.front()].node == culprit ? 1 : 0;
  const bool is_only_one = std::all_of(blamed.begin(), blamed.end(), [&](ComponentId component) {
    return rules[component].node == culprit;
  });
  causes.exact_right = causes.top_right == 1 && is_only_one ? 1 : 0;
  return causes;
}

HonestMetrics honest_metrics(const SunsetRun& run, const RuleSet& rules) {
  HonestMetrics honest;
  honest.downtime_s = seconds(run.honest_downtime);
  honest.strategies = static_cast<std::int32_t>(run.choices.size());
  honest.faults = static_cast<std::int32_t>(run.scenario.faults.size());
  honest.wrong_component = static_cast<std::int32_t>(
      std::count_if(run.choices.begin(), run.choices.end(),
                    [](const SunsetRun::Choice& choice) { return !choice.is_right_place; }));
  honest.unresolved = unresolved(run);
  honest.recovery_s = seconds(run.recovery);
  honest.is_recovery_censored = !run.is_recovered;
  honest.root_causes = root_causes(run, rules);
  return honest;
}

}  // namespace

RunMetrics measure(const SunsetRun& run, const RuleSet& rules, bool has_d_alone) {
  RunMetrics metrics;
  int executed = 0;
  int resolved = 0;
  int redeployments = 0;
  for (const Event& event : run.events) {
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      ++executed;
      if (redeploys(rules[chosen->strategy])) ++redeployments;
    } else if (const auto* done = std::get_if<FailureResolved>(&event.what)) {
      ++resolved;
      metrics.reactions_s.push_back(seconds(done->reaction));
    }
  }
  metrics.ratio = executed == 0 ? 0 : static_cast<double>(resolved) / executed;
  metrics.downtime_s = seconds(run.downtime);
  metrics.unnecessary_redeployments =
      redeployments - (needs_redeployment(outage(run.scenario)) ? 1 : 0);
  metrics.is_left_out = has_d_alone && metrics.unnecessary_redeployments > kTolerableRedeployments;
  metrics.honest = honest_metrics(run, rules);
  return metrics;
}

}  // namespace culprit::study
