// Observations made for one rule file, as another one reads them: things that both name are the
// same.
#pragma once

#include <optional>
#include <vector>

#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::replay {

class Translation {
 public:
  Translation(const RuleSet& from, const RuleSet& to);

  // Empty if the other rules do not refer to it. Replies are dropped, for they answer requests that
  // the other manager did not make. Orders are dropped, too, for they reacted to the recorded
  // manager.
  std::optional<Observation> operator()(const Observation& observation) const;

  // Inputs of the other rules that the recording lacks: "signal exposure", "topic /scan".
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  template <class Id>
  using Map = std::vector<std::optional<Id>>;

  Map<TopicId> topics_;
  Map<SignalId> signals_;
  Map<DiagnosticId> diagnostics_;
  Map<ParameterId> parameters_;
  Map<ComponentId> components_;
  Map<StrategyId> strategies_;
  std::vector<std::string> missing_;
};

}  // namespace culprit::replay
