#include "demo/episode.h"

#include <algorithm>

namespace culprit::lab {

void Episode::add(const Event& event) {
  std::visit([&](const auto& what) { on(what); }, event.what);
}

void Episode::on(const FailureDetected& e) {
  failures_.push_back(rules_[e.rule].name);
  open_.insert(e.rule);
}

void Episode::on(const FailureResolved& e) {
  open_.erase(e.rule);
  reactions_.push_back(e.reaction);
  if (e.strategy) ++strategies_succeeded_;
}

void Episode::on(const StrategyChosen& e) {
  if (e.dry_run) return;
  strategies_.push_back(rules_[e.strategy].name);
  const auto& adaptations = rules_[e.strategy].adaptations;
  const bool redeploys =
      std::any_of(adaptations.begin(), adaptations.end(),
                  [](const Adaptation& a) { return a.type == AdaptationType::kRedeploy; });
  if (redeploys) ++redeployments_;
}

}  // namespace culprit::lab
