#include "demo/episode.h"

#include <algorithm>

namespace culprit::lab {

void Episode::add(const Event& event) {
  std::visit([&](const auto& what) { on(what); }, event.what);
}

void Episode::on(const FailureDetected& e) {
  failures_.push_back(rules_[e.rule].name);
  open_.insert(e.rule);
  if (rules_[e.rule].strategies.empty()) ++calls_;
}

void Episode::on(const FailureResolved& e) {
  open_.erase(e.rule);
  reactions_.push_back(e.reaction);
  if (e.strategy) ++strategies_succeeded_;
}

void Episode::on(const StrategyChosen& e) {
  if (e.dry_run) return;
  strategies_.push_back(rules_[e.strategy].name);
  bool redeploys = false;
  for (const Adaptation& each : rules_[e.strategy].adaptations) {
    if (each.type != AdaptationType::kRedeploy) continue;
    redeploys = true;
    redeployed_.push_back(rules_[each.component].name);
  }
  if (redeploys) ++redeployments_;
}

void Episode::blame(const Incident& incident) {
  for (const ComponentId component : incident.components) {
    const std::string& name = rules_[component].name;
    if (std::ranges::find(blamed_, name) == blamed_.end()) blamed_.push_back(name);
  }
}

PlayOutcome Episode::outcome() const {
  PlayOutcome outcome;
  outcome.failures = failures_;
  outcome.strategies = strategies_;
  outcome.strategies_succeeded = strategies_succeeded_;
  for (const Duration reaction : reactions_) outcome.reaction_times.push_back(seconds(reaction));
  outcome.unresolved = open();
  outcome.blamed = blamed_;
  outcome.redeployed = redeployed_;
  outcome.calls = calls_;
  return outcome;
}

}  // namespace culprit::lab
